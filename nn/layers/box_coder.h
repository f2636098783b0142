// Box regression: a box as four numbers relative to a reference box (an anchor or a proposal).
//
//   x = w_a d_x / k_x + x_a,   y = h_a d_y / k_y + y_a,   w = w_a exp(d_w / k_w),   h = h_a exp(d_h / k_h)
//
// with centres x, y and sizes w, h; weights k = (1, 1, 1, 1) in the RPN and (10, 10, 5, 5) in the box head.
// d_w / k_w and d_h / k_h are clamped at log(1000 / 16), so that exp cannot overflow. Source: Girshick et al.
// 2014, R-CNN, appendix C; torchvision.models.detection._utils.BoxCoder.
#pragma once

#include <cmath>

#include "nn/layers/box.h"

namespace penumbra::nn {

struct BoxCoderWeights {
  float x = 1.0F, y = 1.0F, width = 1.0F, height = 1.0F;
};

inline Box decode_box(const Box& reference, float dx, float dy, float dw, float dh,
                      const BoxCoderWeights& k) {
  static const float kMaxLogScale = std::log(1000.0F / 16.0F);
  const float w = reference.width(), h = reference.height();
  const float cx = dx / k.x * w + (reference.x1 + 0.5F * w);
  const float cy = dy / k.y * h + (reference.y1 + 0.5F * h);
  const float half_w = 0.5F * std::exp(std::min(dw / k.width, kMaxLogScale)) * w;
  const float half_h = 0.5F * std::exp(std::min(dh / k.height, kMaxLogScale)) * h;
  return {cx - half_w, cy - half_h, cx + half_w, cy + half_h};
}

}  // namespace penumbra::nn
