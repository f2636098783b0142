#include "apps/common/run_json.h"

#include "nn/base/error.h"
#include "nn/base/file.h"

namespace penumbra::apps {

nlohmann::json read_run_json(const std::filesystem::path& path) {
  const std::string text = nn::read_text_file(path, "a file that `penumbra slam` or `penumbra brain` wrote");
  nlohmann::json value = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!value.is_object()) throw InputError(path.string(), "a JSON object", "something else, or a torn file");
  return value;
}

}  // namespace penumbra::apps
