// Masks of people from boxes and the depths of feature points: a segmenter made of another one, of which only
// the boxes are used.
//
//   boxes of a detector -> the features' depths in each and around it -> which of them are the person's
//     (foreground_depths.h) -> the box's pixels at those depths, as the mask
//
// So what lies behind a person in its box stays with the world. A pixel without depth goes with the nearest
// one of its row that has one, a row without any depth belongs to the person.
//
//   no depth image, no features, too few of them, or no depth that stands out    the whole box is the mask
//   depth of another size                                                        InputError
//
// Cost: 0.1 ms a box of 200 x 400 pixels.
// Source: see foreground_depths.h.
#pragma once

#include "slam/dynamics/instance.h"
#include "slam/dynamics/rgbd/foreground_depths.h"

namespace penumbra::slam {

// `boxes` finds instances, whose regions are their boxes and may reach beyond the image. Those below
// `least_score` are left out.
Segmenter masks_by_dbscan(Segmenter boxes, double least_score, const ForegroundSettings& settings);

}  // namespace penumbra::slam
