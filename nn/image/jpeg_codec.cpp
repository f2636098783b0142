#include "nn/image/jpeg_codec.h"

#include <jpeglib.h>  // after cstdio, which it needs

#include <csetjmp>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "nn/base/error.h"
#include "nn/image/colour.h"

namespace penumbra::nn {

namespace {

// libjpeg fails by a jump to guarded(), which passes over frames without running destructors: the functions
// that guarded() calls have nothing to destroy.
struct JpegErrors {
  jpeg_error_mgr manager;  // first, so that its address is ours
  std::jmp_buf place;
  char words[JMSG_LENGTH_MAX];
};

void fail(j_common_ptr codec) {
  auto* errors = reinterpret_cast<JpegErrors*>(codec->err);
  codec->err->format_message(codec, errors->words);
  std::longjmp(errors->place, 1);
}
void ignore(j_common_ptr /*codec*/) {}

// Keeps the first warning's words; `level` -1 is a warning, others are traces.
void note(j_common_ptr codec, int level) {
  auto* errors = reinterpret_cast<JpegErrors*>(codec->err);
  if (level < 0 && errors->manager.num_warnings++ == 0) codec->err->format_message(codec, errors->words);
}

void set_errors(JpegErrors& errors) {
  jpeg_std_error(&errors.manager);
  errors.manager.error_exit = fail;
  errors.manager.output_message = ignore;
  errors.manager.emit_message = note;
  errors.words[0] = '\0';
}

struct DecodeJob {
  jpeg_decompress_struct codec{};
  JpegErrors errors{};
  std::string_view bytes;
  bool grey = false;
  std::vector<JSAMPROW> rows;
};

struct EncodeJob {
  jpeg_compress_struct codec{};
  JpegErrors errors{};
  ByteView image;
  int quality = 95;
  unsigned char* output = nullptr;
  unsigned long size = 0;
};

template <class Job>
bool guarded(void (*step)(Job&), Job& job) {
  if (setjmp(job.errors.place) != 0) return false;
  step(job);
  return true;
}

void begin_decoding(DecodeJob& job) {
  jpeg_create_decompress(&job.codec);
  jpeg_mem_src(&job.codec, reinterpret_cast<const unsigned char*>(job.bytes.data()), job.bytes.size());
  jpeg_read_header(&job.codec, TRUE);
  const bool inks = job.codec.num_components == 4;
  job.codec.out_color_space = inks ? JCS_CMYK : job.grey ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_start_decompress(&job.codec);
}

void decode_rows(DecodeJob& job) {
  while (job.codec.output_scanline < job.codec.output_height) {
    const JDIMENSION left = job.codec.output_height - job.codec.output_scanline;
    jpeg_read_scanlines(&job.codec, job.rows.data() + job.codec.output_scanline, left);
  }
  jpeg_finish_decompress(&job.codec);
}

ByteImage inks_to_bgr(const ByteImage& inks) {
  ByteImage bgr(inks.width(), inks.height(), 3);
  for (int y = 0; y < inks.height(); ++y) {
    const std::uint8_t* in = inks.row(y);
    std::uint8_t* out = bgr.row(y);
    for (int x = 0; x < inks.width(); ++x, in += 4, out += 3) {
      for (int c = 0; c < 3; ++c) out[2 - c] = static_cast<std::uint8_t>((in[c] * in[3] + 127) / 255);
    }
  }
  return bgr;
}

void encode_rows(EncodeJob& job) {
  jpeg_create_compress(&job.codec);
  jpeg_mem_dest(&job.codec, &job.output, &job.size);
  job.codec.image_width = static_cast<JDIMENSION>(job.image.width);
  job.codec.image_height = static_cast<JDIMENSION>(job.image.height);
  job.codec.input_components = job.image.channels;
  job.codec.in_color_space = job.image.channels == 1 ? JCS_GRAYSCALE : JCS_EXT_BGR;
  jpeg_set_defaults(&job.codec);
  jpeg_set_quality(&job.codec, job.quality, TRUE);
  jpeg_start_compress(&job.codec, TRUE);
  for (int y = 0; y < job.image.height; ++y) {
    JSAMPROW row = const_cast<JSAMPROW>(job.image.row(y));  // libjpeg only reads it
    jpeg_write_scanlines(&job.codec, &row, 1);
  }
  jpeg_finish_compress(&job.codec);
}

}  // namespace

ByteImage decode_jpeg(std::string_view bytes, bool grey, std::string_view place) {
  DecodeJob job;
  job.bytes = bytes;
  job.grey = grey;
  set_errors(job.errors);
  job.codec.err = &job.errors.manager;
  ByteImage image;
  bool done = guarded(begin_decoding, job);
  if (done) {
    image.create(static_cast<int>(job.codec.output_width), static_cast<int>(job.codec.output_height),
                 job.codec.output_components);
    for (int y = 0; y < image.height(); ++y) job.rows.push_back(image.row(y));
    done = guarded(decode_rows, job);
  }
  jpeg_destroy_decompress(&job.codec);
  if (!done) {
    throw InputError(place, "a JPEG whose rows can be read",
                     fmt::format("a file that the decoder refuses: {}", job.errors.words));
  }
  if (job.errors.manager.num_warnings > 0) {
    fmt::print(stderr, "warning: {}: parts of the picture may be wrong: {}\n", place, job.errors.words);
  }
  if (image.channels() == 4) image = inks_to_bgr(image);
  return with_channels(image, grey ? 1 : 3);
}

std::string encode_jpeg(const ByteView& image, int quality) {
  EncodeJob job;
  job.image = image;
  job.quality = quality;
  set_errors(job.errors);
  job.codec.err = &job.errors.manager;
  const bool done = guarded(encode_rows, job);
  std::string bytes(reinterpret_cast<const char*>(job.output), done ? job.size : 0);
  jpeg_destroy_compress(&job.codec);
  std::free(job.output);
  if (!done) throw Error(fmt::format("cannot encode a JPEG: {}", job.errors.words));
  return bytes;
}

}  // namespace penumbra::nn
