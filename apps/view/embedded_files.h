// Files that are part of the program: CMake puts their bytes into it (embedded_files.cpp.in).
#pragma once

#include <string_view>

namespace penumbra::apps::embedded {

std::string_view page_html();      // apps/view/report/page.html
std::string_view page_css();       // apps/view/report/page.css
std::string_view page_js();        // apps/view/report/page.js
std::string_view live_html();      // apps/view/report/live.html
std::string_view live_js();        // apps/view/report/live.js
std::string_view fleet_step_sh();  // apps/fleet/scripts/step.sh
std::string_view fleet_submit_sh();
std::string_view fleet_here_sh();
std::string_view three_js();        // three.js, from Debian's libjs-three (MIT licence)
std::string_view orbit_controls();  // its OrbitControls.js
std::string_view three_js_licence();
std::string_view licences();  // of all libraries in the program and the page, see licences.cmake

}  // namespace penumbra::apps::embedded
