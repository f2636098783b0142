// Files that are part of the program: CMake puts their bytes into it (embedded_files.cpp.in).
#pragma once

#include <string_view>

namespace penumbra::apps::embedded {

std::string_view page_html();       // apps/report/page.html
std::string_view page_css();        // apps/report/page.css
std::string_view page_js();         // apps/report/page.js
std::string_view live_html();       // apps/report/live.html
std::string_view live_js();         // apps/report/live.js
std::string_view three_js();        // three.js, from Debian's libjs-three (MIT licence)
std::string_view orbit_controls();  // its OrbitControls.js

}  // namespace penumbra::apps::embedded
