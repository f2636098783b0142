// The HTML page about a run of `penumbra slam`: of a finished one, or of one that is under way.
#pragma once

#include <filesystem>
#include <string>

#include "apps/view/report_data.h"

namespace penumbra::apps {

// The page for a folder that `penumbra slam` wrote (apps/view/report_data.h). Everything is inside the page,
// three.js included: it opens without a network. Of the map at most `most_points` points are taken. Throws
// InputError for a folder that holds no run, or a damaged one.
std::string make_report_page(const std::filesystem::path& run_folder,
                             std::size_t most_points = kMostPagePoints);

// The same page without a run in it: it asks the server that it came from (apps/view/live_view.h).
std::string make_live_page(const std::string& title);

}  // namespace penumbra::apps
