// Says what is in images: detect WEIGHTS IMAGE...
#include <penumbra/image_file.h>
#include <penumbra/segmenter.h>

#include <cstdio>
#include <exception>

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: detect WEIGHTS IMAGE...\n");
    return 2;
  }
  penumbra::Segmenter segmenter(argv[1]);
  for (int i = 2; i < argc; ++i) {
    const penumbra::ImageFile image = penumbra::read_image(argv[i], /*colour=*/true);
    for (const penumbra::Instance& thing : segmenter.find(image.view()))
      std::printf("%s: %s %.2f at %.0f %.0f, %.0f x %.0f pixels\n", argv[i], thing.class_name.c_str(),
                  thing.score, thing.x1, thing.y1, thing.x2 - thing.x1, thing.y2 - thing.y1);
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "detect: %s\n", error.what());
  return 1;
}
