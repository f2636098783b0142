// What the SLAM's instances come from: a network, or masks that are there already.
#pragma once

#include <filesystem>

#include "apps/network/loaded_network.h"
#include "slam/dynamics/instance.h"
#include "slam/pipeline/slam.h"

namespace penumbra::apps {

// Settings of a network whose masks the SLAM uses.
nn::NetworkConfig slam_network_config();

// The segmenter shares the network, Mask R-CNN or YOLOv5, and finds what DepthMaskSettings::masks says: the
// network's masks (InputError where it finds boxes only), or its boxes, as masks or to look for the objects
// in them by depth.
slam::Segmenter make_segmenter(const LoadedNetwork& loaded, const slam::StereoCamera& camera,
                               const slam::SemanticsSettings& settings);

// The same instances with the masks that DepthMaskSettings::masks says.
slam::Segmenter refine_masks(slam::Segmenter segmenter, const slam::StereoCamera& camera,
                             const slam::SemanticsSettings& settings);

// Score below which the network's instances are left out, unless a user says otherwise: detectors that draw
// boxes alone give people lower scores than Mask R-CNN does.
double least_score_of(const LoadedNetwork& loaded);

// The same of masks that are there already: their bounding boxes are the boxes.
slam::Segmenter make_segmenter(const std::filesystem::path& masks, const slam::StereoCamera& camera,
                               const slam::SemanticsSettings& settings);

// Reads masks as `penumbra synth` writes them: folder/NNNNNN.png with 16-bit instance numbers (NNNNNN: the
// frame's; where no name is such a number, the images in the order of their names; 0: background) and, beside
// the folder or in it, instances.json with their classes,
// {"17": {"class": "car"}}. Scores are 1. A frame without a file shows nothing. Throws InputError for files
// that are not that, from here or from the segmenter.
slam::Segmenter make_mask_reader(const std::filesystem::path& folder);
// Reads masks as DynaSLAM saves them: 8-bit images, found in the same way, that are 0 on people and wider
// than these; `margin` pixels are taken off. What hangs together is one person. Errors as above, and
// InputError for a folder without masks.
slam::Segmenter make_people_mask_reader(const std::filesystem::path& folder, int margin);

}  // namespace penumbra::apps
