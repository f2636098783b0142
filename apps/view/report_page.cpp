#include "apps/view/report_page.h"

#include <algorithm>
#include <map>

#include "apps/view/embedded_files.h"
#include "apps/view/report_data.h"
#include "nn/base/text.h"

namespace penumbra::apps {

namespace {

using nlohmann::json;

// JSON in which no "</script>" can end the element that holds it.
std::string script_safe(const json& value) {
  std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
  for (std::size_t at = text.find('<'); at != text.npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  return text;
}

// The template with its parts filled in; a part that is not given is left out.
std::string fill_page(std::map<std::string_view, std::string> parts) {
  parts["@STYLE@"] = embedded::page_css();
  parts["@THREE@"] = embedded::three_js();
  parts["@CONTROLS@"] = embedded::orbit_controls();
  parts["@LICENCE@"] = as_markup(embedded::three_js_licence());
  parts["@SCRIPT@"] = embedded::page_js();
  parts.insert({{"@NOW@", ""}, {"@LIVE@", ""}});
  // One pass over the template: what is put in is not searched again.
  const std::string_view html = embedded::page_html();
  std::string page;
  for (std::size_t at = 0; at < html.size();) {
    const auto part = std::find_if(parts.begin(), parts.end(),
                                   [&](const auto& p) { return html.substr(at, p.first.size()) == p.first; });
    if (part != parts.end()) {
      page += part->second;
      at += part->first.size();
    } else {
      page += html[at++];
    }
  }
  return page;
}

}  // namespace

std::string make_report_page(const std::filesystem::path& run_folder, std::size_t most_points) {
  const json data = report_data(run_folder, most_points);
  const json& name = data["run"]["dataset"];
  return fill_page(
      {{"@TITLE@", as_markup(name.is_string() ? name.get<std::string>() : run_folder.string())},
       {"@DATA@", script_safe(data)},
       {"@MAKER@",
        "Written by <code>penumbra report</code>. The page holds all it shows; it needs no network."}});
}

std::string make_live_page(const std::string& title) {
  return fill_page({{"@TITLE@", as_markup(title)},
                    {"@DATA@", "null"},
                    {"@NOW@", std::string(embedded::live_html())},
                    {"@LIVE@", std::string(embedded::live_js())},
                    {"@MAKER@",
                     "Served by <code>penumbra slam --view</code> on this machine. When the run has ended "
                     "the page needs it no more."}});
}

}  // namespace penumbra::apps
