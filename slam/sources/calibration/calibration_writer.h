// Which tool wrote a calibration file that is not ours, told by its keys: so that a message can name it.
#pragma once

#include <filesystem>
#include <string>

namespace penumbra::slam {

// "Kalibr's camchain", "ORB-SLAM's settings", ...; empty where nothing gives it away or the file is not
// readable.
std::string calibration_writer(const std::filesystem::path& path);

}  // namespace penumbra::slam
