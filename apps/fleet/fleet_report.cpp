#include "apps/fleet/fleet_report.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"

namespace penumbra::apps {

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  return fs::exists(path) ? nn::read_text_file(path, "text") : std::string();
}

// Of the last attempt: its error, or else its last line.
std::string last_words_of(const fs::path& log) {
  std::istringstream text(text_of(log));
  std::string error, last;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with("== ")) {
      error.clear();
      last.clear();
    } else if (line.starts_with("error: ")) {
      error = line.substr(7);
    }
    if (!line.empty()) last = line;
  }
  return printable(error.empty() ? last : error, 300);
}

// Whether step.sh holds it.
bool is_locked(const fs::path& lock) {
  const int file = ::open(lock.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return false;
  const bool locked = ::flock(file, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(file);  // and lets go
  return locked;
}

// What a damaged or half-written run.json does not say stays unknown.
void read_figures(const fs::path& file, FleetRow& row) {
  const nlohmann::json run = nlohmann::json::parse(text_of(file), nullptr, false);
  if (!run.is_object()) return;
  const auto number = [](const nlohmann::json& of, const char* key, auto& value) {
    if (const auto found = of.find(key); found != of.end() && found->is_number()) found->get_to(value);
  };
  number(run, "frames", row.frames);
  number(run, "tracked", row.located);
  number(run, "keyframes", row.keyframes);
  number(run, "path_m", row.path_m);
  if (const auto truth = run.find("ground_truth"); truth != run.end() && truth->is_object())
    number(*truth, "ape_rmse_m", row.ape_m);
  if (row.state == FleetState::failed && run.contains("error") && run["error"].is_string() &&
      run["error"].get<std::string>().starts_with("interrupted"))
    row.state = FleetState::stopped;
}

// Line by line, without control characters.
std::string printable_lines(const std::string& text) {
  std::istringstream lines(text);
  std::string shown;
  for (std::string line; std::getline(lines, line);) shown += printable(line, 300) + '\n';
  return shown;
}

std::string figure(double value, const char* format) {
  return value < 0 ? std::string("-") : fmt::format(fmt::runtime(format), value);
}

std::vector<std::string> cells_of(const FleetRow& row) {
  return {row.name,
          name_of(row.state),
          figure(row.frames, "{:.0f}"),
          figure(row.located, "{:.0f}"),
          figure(row.keyframes, "{:.0f}"),
          figure(row.path_m, "{:.1f}"),
          figure(row.ape_m, "{:.4f}"),
          row.last_words};
}

constexpr const char* kHeadings[] = {"recording", "state",  "frames", "located",
                                     "keyframes", "path m", "APE m",  "last words"};

constexpr const char* kStyle =
    "body{font:15px/1.5 sans-serif;max-width:75em;margin:2em auto;padding:0 1em;color:#2d2d2d}"
    "table{border-collapse:collapse;width:100%}td,th{padding:.3em .6em;border-bottom:1px solid #ddd;"
    "text-align:left;vertical-align:top}td:nth-child(n+3):nth-child(-n+7){text-align:right}"
    "tr.failed td:nth-child(2),tr.stopped td:nth-child(2){color:#d55e00;font-weight:bold}"
    "figure{display:inline-block;width:22em;margin:1em 1em 0 0}img{width:100%}pre{white-space:pre-wrap}";

}  // namespace

const char* name_of(FleetState state) {
  switch (state) {
    case FleetState::done:
      return "done";
    case FleetState::at_work:
      return "at work";
    case FleetState::stopped:
      return "stopped";
    case FleetState::failed:
      return "failed";
    case FleetState::not_begun:
      break;
  }
  return "not begun";
}

std::vector<FleetRow> read_fleet(const fs::path& plan) {
  std::istringstream jobs(nn::read_text_file(plan / "jobs.tsv", "the plan of `penumbra fleet plan`"));
  std::vector<FleetRow> rows;
  for (std::string line; std::getline(jobs, line);) {
    const std::size_t tab = line.find('\t');
    FleetRow row;
    row.name = line.substr(0, tab);
    const fs::path run = plan / "runs" / row.name;
    const std::string job = tab == line.npos ? std::string() : line.substr(tab + 1);
    const std::string done = text_of(run / "done");
    if (is_locked(run / "lock"))
      row.state = FleetState::at_work;
    else if (!done.empty())
      row.state = done == job + '\n' ? FleetState::done : FleetState::not_begun;
    else if (fs::exists(run / "log.txt"))
      row.state = FleetState::failed;
    if (row.state == FleetState::done || row.state == FleetState::failed) read_figures(run / "run.json", row);
    if (row.state == FleetState::failed || row.state == FleetState::stopped)
      row.last_words = last_words_of(run / "log.txt");
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string why_not_merged(const fs::path& plan) {
  if (fs::exists(plan / "merged/done")) return {};
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(plan / "merged", none)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with("district-") || fs::exists(entry.path() / "done")) continue;
    const std::string words = last_words_of(entry.path() / "log.txt");
    if (!words.empty()) return name + ": " + words;
  }
  const std::string words = last_words_of(plan / "merged/log.txt");
  return words.empty() ? "not begun" : words;
}

std::string fleet_table(const std::vector<FleetRow>& rows) {
  std::string table = fmt::format("{}\n", fmt::join(kHeadings, "\t"));
  for (const FleetRow& row : rows) table += fmt::format("{}\n", fmt::join(cells_of(row), "\t"));
  return table;
}

std::string fleet_page(const fs::path& plan, const std::vector<FleetRow>& rows) {
  std::string page = fmt::format(
      "<!DOCTYPE html><html lang=\"en\"><meta charset=\"utf-8\"><title>Fleet</title><style>{}</style>"
      "<h1>Done: {} of {}</h1><table><tr>",
      kStyle, std::ranges::count(rows, FleetState::done, &FleetRow::state),
      counted(rows.size(), "recording"));
  for (const char* heading : kHeadings) page += fmt::format("<th>{}</th>", heading);
  page += "</tr>";
  for (const FleetRow& row : rows) {
    page += fmt::format("<tr class=\"{}\">", name_of(row.state));
    std::vector<std::string> cells = cells_of(row);
    for (std::string& cell : cells) cell = as_markup(cell);
    if (row.state != FleetState::not_begun) cells[0] = fmt::format("<a href=\"runs/{0}/\">{0}</a>", cells[0]);
    for (const std::string& cell : cells) page += fmt::format("<td>{}</td>", cell);
    page += "</tr>";
  }
  page += "</table>";
  if (const std::string merged = text_of(plan / "merged/log.txt"); !merged.empty())
    page += fmt::format("<h2>The merged map</h2><pre>{}</pre>", as_markup(printable_lines(merged)));
  page += "<h2>The paths, each by itself</h2>";
  for (const FleetRow& row : rows) {
    if (!fs::exists(plan / "runs" / row.name / "trajectory.svg")) continue;
    page += fmt::format(
        "<figure><a href=\"runs/{0}/trajectory.svg\"><img loading=\"lazy\" src=\"runs/{0}/trajectory.svg\" "
        "alt=\"the path of {0}\"></a><figcaption>{0}</figcaption></figure>",
        as_markup(row.name));
  }
  return page + "</html>\n";
}

}  // namespace penumbra::apps
