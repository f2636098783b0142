// Polygons to masks, pixel for pixel as the COCO API draws them: other fill rules differ along the whole
// outline, which moves mask AP.
//
// The rule: vertices are rounded onto a grid five times finer than the pixels, (int)(5 x + 0.5). Every edge
// becomes the grid points nearest to it, one for each step along its longer side. Column k of the image is
// crossed where the outline steps between grid columns 5k + 2 and 5k + 3, the two about its middle; the
// crossing is at the smaller grid row v of that step, pixel row ceil((v + 0.5) / 5 - 0.5) within
// [0, height]. Between the first and second crossing of a column its pixels are 1, between the third and
// fourth again, and so on.
//
// Source: the COCO API's maskApi.c, rleFrPoly, whose rule this is; it walks every grid point, here each edge
// goes straight to the columns it crosses.
#pragma once

#include <span>
#include <vector>

#include "nn/evaluation/run_mask.h"

namespace penumbra::nn {

// `xy` is x0 y0 x1 y1 ..., closed by itself, in pixels, within +-kLargestCoordinate; it may leave the
// image. Cost: the sum over all edges of the image columns that each of them crosses, and sorting those.
RunMask rasterise_polygon(std::span<const double> xy, int width, int height);

// The union of polygons: the parts of one object.
RunMask rasterise_polygons(const std::vector<std::vector<double>>& polygons, int width, int height);

}  // namespace penumbra::nn
