// The caller's pixels as the pipeline takes them.
#pragma once

#include "nn/image/image.h"
#include "penumbra/image.h"

namespace penumbra {

// `place`: for errors, such as "left image". InputError where there are no pixels, another format than grey
// or colour, rows shorter than their pixels, or another size than `size` (0 x 0: any). A copy: the pipeline
// may look at it after the caller has taken his pixels back.
ByteImage byte_image_of(const ImageRef& image, const Size& size, const char* place);
// 16-bit depth in units, or metres as floats: what the other is not asked for stays empty.
WordImage depth_units_of(const ImageRef& image, const Size& size);
FloatImage depth_metres_of(const ImageRef& image, const Size& size);

}  // namespace penumbra
