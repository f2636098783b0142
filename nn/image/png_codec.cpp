#include "nn/image/png_codec.h"

#include <png.h>
#include <zlib.h>

#include <bit>
#include <cstring>
#include <vector>

#include "nn/base/error.h"

namespace penumbra::nn {

namespace {

static_assert(std::endian::native == std::endian::little,
              "16-bit values are swapped: PNG has the high byte first");

// What libpng reads and writes. It fails by a jump to guarded(), which passes over frames without running
// destructors: the functions that guarded() calls have nothing to destroy.
struct PngJob {
  std::string_view input;
  std::size_t position = 0;
  std::string output;
  std::string failure;
  ImageColour colour = ImageColour::stored;
  bool eight_bits = false;
  int bits = 8;
  Size size;
  int channels = 1;
  std::vector<png_bytep> rows;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

void fail(png_structp png, png_const_charp words) {
  static_cast<PngJob*>(png_get_error_ptr(png))->failure = words;
  png_longjmp(png, 1);
}
void ignore(png_structp /*png*/, png_const_charp /*words*/) {}

void read_input(png_structp png, png_bytep out, std::size_t size) {
  auto& job = *static_cast<PngJob*>(png_get_io_ptr(png));
  if (size > job.input.size() - job.position) png_error(png, "the file ends too early");
  std::memcpy(out, job.input.data() + job.position, size);
  job.position += size;
}

void write_output(png_structp png, png_bytep bytes, std::size_t size) {
  static_cast<PngJob*>(png_get_io_ptr(png))->output.append(reinterpret_cast<const char*>(bytes), size);
}
void flush_output(png_structp /*png*/) {}

bool guarded(void (*step)(PngJob&), PngJob& job) {
  if (setjmp(png_jmpbuf(job.png)) != 0) return false;
  step(job);
  return true;
}

// Reads the header and asks for the wanted kind of rows.
void begin_reading(PngJob& job) {
  png_set_read_fn(job.png, &job, read_input);
  png_read_info(job.png, job.info);
  const int type = png_get_color_type(job.png, job.info), depth = png_get_bit_depth(job.png, job.info);
  const bool has_colour = (type & PNG_COLOR_MASK_COLOR) != 0;
  if (depth == 16) {
    if (job.eight_bits) {
      png_set_strip_16(job.png);
    } else {
      png_set_swap(job.png);
    }
  }
  png_set_strip_alpha(job.png);
  if (type == PNG_COLOR_TYPE_PALETTE) png_set_palette_to_rgb(job.png);
  if (!has_colour && depth < 8) png_set_expand_gray_1_2_4_to_8(job.png);
  const bool wants_colour =
      job.colour == ImageColour::bgr || (job.colour == ImageColour::stored && has_colour);
  if (wants_colour) {
    if (has_colour) {
      png_set_bgr(job.png);
    } else {
      png_set_gray_to_rgb(job.png);
    }
  } else if (has_colour) {
    png_set_rgb_to_gray(job.png, PNG_ERROR_ACTION_NONE, 0.299, 0.587);
  }
  png_set_interlace_handling(job.png);
  png_read_update_info(job.png, job.info);
  job.bits = png_get_bit_depth(job.png, job.info);
  job.channels = png_get_channels(job.png, job.info);
}

void read_rows(PngJob& job) {
  png_read_image(job.png, job.rows.data());
  png_read_end(job.png, nullptr);
}

void write_image(PngJob& job) {
  png_set_write_fn(job.png, &job, write_output, flush_output);
  // Fast, and for pictures as small as slower settings make them.
  png_set_filter(job.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
  png_set_compression_level(job.png, Z_BEST_SPEED);
  png_set_compression_strategy(job.png, Z_RLE);
  png_set_IHDR(job.png, job.info, static_cast<png_uint_32>(job.size.width),
               static_cast<png_uint_32>(job.size.height), job.bits,
               job.channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_write_info(job.png, job.info);
  if (job.channels == 3) png_set_bgr(job.png);
  if (job.bits == 16) png_set_swap(job.png);
  png_write_image(job.png, job.rows.data());
  png_write_end(job.png, job.info);
}

// Frees what libpng took, however the work ends.
struct ReadStruct {
  explicit ReadStruct(PngJob& j) : job(j) {
    job.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &job, fail, ignore);
    job.info = png_create_info_struct(job.png);
  }
  ~ReadStruct() { png_destroy_read_struct(&job.png, &job.info, nullptr); }
  PngJob& job;
};
struct WriteStruct {
  explicit WriteStruct(PngJob& j) : job(j) {
    job.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &job, fail, ignore);
    job.info = png_create_info_struct(job.png);
  }
  ~WriteStruct() { png_destroy_write_struct(&job.png, &job.info); }
  PngJob& job;
};

template <class T>
void make_rows(Image<T>& image, const ImageInfo& info, PngJob& job) {
  image.create(info.width, info.height, job.channels);
  for (int y = 0; y < info.height; ++y) job.rows.push_back(reinterpret_cast<png_bytep>(image.row(y)));
}

template <class T>
std::string encode(const ImageView<const T>& image) {
  PngJob job;
  job.bits = 8 * static_cast<int>(sizeof(T));
  job.size = image.size();
  job.channels = image.channels;
  for (int y = 0; y < image.height; ++y) {
    job.rows.push_back(reinterpret_cast<png_bytep>(const_cast<T*>(image.row(y))));  // libpng only reads them
  }
  const WriteStruct structs(job);
  if (!guarded(write_image, job)) throw Error(fmt::format("cannot encode a PNG: {}", job.failure));
  return std::move(job.output);
}

}  // namespace

StoredImage decode_png(std::string_view bytes, const ImageInfo& info, ImageColour colour, bool eight_bits,
                       std::string_view place) {
  StoredImage image;
  image.info = info;
  if (decode_plain_png(bytes, colour, eight_bits, image)) return image;
  image = {};
  PngJob job;
  job.input = bytes;
  job.colour = colour;
  job.eight_bits = eight_bits;
  const ReadStruct structs(job);
  image.info = info;
  bool done = guarded(begin_reading, job);
  if (done) {
    if (job.bits == 16) {
      make_rows(image.words, info, job);
    } else {
      make_rows(image.bytes, info, job);
    }
    done = guarded(read_rows, job);
  }
  if (!done) {
    throw InputError(place, "a PNG whose rows can be read",
                     fmt::format("a file that the decoder refuses: {}", job.failure));
  }
  return image;
}

std::string encode_png(const ByteView& image) { return encode(image); }
std::string encode_png(const ImageView<const std::uint16_t>& image) { return encode(image); }

}  // namespace penumbra::nn
