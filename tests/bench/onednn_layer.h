// A convolution by oneDNN 2, for benchmarks.
#pragma once

#include <algorithm>
#include <dnnl.hpp>
#include <string>
#include <unordered_map>

#include "apps/bench/conv_layers.h"

namespace penumbra {

// The same layer by oneDNN, with its own choice of layouts; bias, sum and ReLU fused as ours.
class OneDnnLayer {
 public:
  OneDnnLayer(const apps::ConvShape& shape, nn::Precision precision)
      : engine_(dnnl::engine::kind::cpu, 0), stream_(engine_) {
    using dnnl::memory;
    using Type = memory::data_type;
    const bool int8 = precision == nn::Precision::int8;
    const Type values = int8 ? Type::u8 : precision == nn::Precision::bf16 ? Type::bf16 : Type::f32;
    const Type weights = int8 ? Type::s8 : values;
    const int padding = shape.kernel / 2, s = shape.stride;
    const int height = (shape.height + 2 * padding - shape.kernel) / s + 1;
    const int width = (shape.width + 2 * padding - shape.kernel) / s + 1;
    const auto any = [](memory::dims dims, Type type) {
      return memory::desc(dims, type, memory::format_tag::any);
    };
    const dnnl::convolution_forward::desc description(
        dnnl::prop_kind::forward_inference, dnnl::algorithm::convolution_auto,
        any({shape.images, shape.channels, shape.height, shape.width}, values),
        any({shape.outputs, shape.channels, shape.kernel, shape.kernel}, weights),
        memory::desc({shape.outputs}, Type::f32, memory::format_tag::x),
        any({shape.images, shape.outputs, height, width}, values), {s, s}, {padding, padding},
        {padding, padding});
    dnnl::post_ops after;
    if (shape.residual) after.append_sum(1.0F);
    after.append_eltwise(1.0F, dnnl::algorithm::eltwise_relu, 0.0F, 0.0F);
    dnnl::primitive_attr attributes;
    attributes.set_post_ops(after);
    if (int8) attributes.set_output_scales(0, {0.01F});
    const dnnl::convolution_forward::primitive_desc chosen(description, attributes, engine_);
    implementation_ = chosen.impl_info_str();
    convolution_ = dnnl::convolution_forward(chosen);
    arguments_ = {{DNNL_ARG_SRC, filled(chosen.src_desc())},
                  {DNNL_ARG_WEIGHTS, filled(chosen.weights_desc())},
                  {DNNL_ARG_BIAS, filled(chosen.bias_desc())},
                  {DNNL_ARG_DST, filled(chosen.dst_desc())}};
  }
  void run() {
    convolution_.execute(stream_, arguments_);
    stream_.wait();
  }
  const std::string& implementation() const { return implementation_; }

 private:
  // These bytes are 0.0115 in f32 and bf16, and 60.
  dnnl::memory filled(const dnnl::memory::desc& description) const {
    dnnl::memory memory(description, engine_);
    std::fill_n(static_cast<unsigned char*>(memory.get_data_handle()), description.get_size(), 0x3C);
    return memory;
  }
  dnnl::engine engine_;
  dnnl::stream stream_;
  dnnl::convolution_forward convolution_;
  std::unordered_map<int, dnnl::memory> arguments_;
  std::string implementation_;
};

}  // namespace penumbra
