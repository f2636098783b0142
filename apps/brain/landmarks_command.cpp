// penumbra brain landmarks: images in, their landmarks with class and interest out, as pictures and JSON.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/brain/landmark_finder.h"
#include "apps/brain/landmark_picture.h"
#include "apps/common/commands.h"
#include "apps/common/compute_options.h"
#include "apps/common/finite_number.h"
#include "apps/common/interruption.h"
#include "apps/common/log.h"
#include "apps/common/progress_bar.h"
#include "apps/network/image_list.h"
#include "nn/base/counted.h"
#include "nn/base/error.h"
#include "nn/base/file.h"
#include "nn/base/text.h"
#include "nn/image/grey.h"
#include "nn/image/image_file.h"
#include "slam/frontend/features/orb_extractor.h"

namespace penumbra::apps {

namespace {

struct LandmarksOptions {
  std::vector<std::string> images;
  std::filesystem::path weights, out;
  nn::ImageOrientation orientation = nn::ImageOrientation::upright;
  bool pictures = true;
  slam::brain::RegionSettings regions;
};

nlohmann::ordered_json landmark_json(const slam::brain::Landmark& landmark) {
  return {{"class", name_of(static_cast<slam::brain::LandmarkClass>(landmark.landmark_class))},
          {"score", landmark.score},
          {"interest", landmark.interest},
          {"box", {landmark.x0, landmark.y0, landmark.x1, landmark.y1}},
          {"descriptor", landmark.descriptor}};
}

// One run over all images; one that cannot be read is reported and the others are still done.
class LandmarksRun {
 public:
  explicit LandmarksRun(const LandmarksOptions& options)
      : options_(options), find_(options.weights, options.regions), extractor_(slam::OrbSettings{}) {}

  void run(const std::vector<ListedImage>& images) {
    std::optional<ProgressBar> progress;
    if (images.size() > 1) progress.emplace("Landmarks", static_cast<int>(images.size()), "images");
    for (const ListedImage& listed : images) {
      if (Interruption::requested()) break;
      one(listed);
      if (progress) progress->update(static_cast<int>(report_.size() + failed_));
    }
    progress.reset();
    if (report_.empty() && failed_ > 0)
      throw Error(fmt::format("{} of {} could not be read", failed_, counted(images.size(), "image")));
    const std::filesystem::path file = options_.out / "landmarks.json";
    const nlohmann::ordered_json content = {{"weights", printable(options_.weights.string(), 400)},
                                            {"images", report_}};
    nn::write_file(file, content.dump() + "\n");
    fmt::print("{}, {:.1f} landmarks and {:.1f} ms an image; {}\n", counted(report_.size(), "image"),
               static_cast<double>(found_) / static_cast<double>(std::max<std::size_t>(report_.size(), 1)),
               1e3 * seconds_ / static_cast<double>(std::max<std::size_t>(report_.size(), 1)), file.string());
    if (Interruption::requested())
      throw Error(fmt::format("interrupted by {} after {} of {}", Interruption::signal_name(),
                              report_.size() + failed_, counted(images.size(), "image")));
    if (failed_ > 0)
      throw Error(fmt::format("{} of {} could not be read", failed_, counted(images.size(), "image")));
  }

 private:
  void one(const ListedImage& listed) {
    ByteImage image;
    try {
      image = read_listed_image(listed, options_.orientation);
    } catch (const Error& error) {
      log_error("{}", error.what());
      ++failed_;
      return;
    }
    const auto start = std::chrono::steady_clock::now();
    find_(image, landmarks_);
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    found_ += landmarks_.size();
    nlohmann::ordered_json entries = nlohmann::ordered_json::array();
    for (const slam::brain::Landmark& landmark : landmarks_) entries.push_back(landmark_json(landmark));
    nlohmann::ordered_json entry = {{"path", printable(listed.path.string(), 400)},
                                    {"width", image.width()},
                                    {"height", image.height()},
                                    {"landmarks", std::move(entries)}};
    if (options_.pictures) {
      extractor_.extract(to_grey(image), features_);
      const std::filesystem::path picture = options_.out / picture_name(listed);
      nn::write_image(picture, landmark_picture(image, landmarks_, features_));
      entry["picture"] = printable(picture.string(), 400);
    }
    report_.push_back(std::move(entry));
  }

  const LandmarksOptions& options_;
  ImageLandmarks find_;
  slam::OrbExtractor extractor_;
  slam::Features features_;
  slam::brain::Landmarks landmarks_;
  nlohmann::ordered_json report_ = nlohmann::ordered_json::array();  // an entry an image
  std::size_t found_ = 0, failed_ = 0;
  double seconds_ = 0.0;
};

void find_landmarks(const LandmarksOptions& options) {
  const std::vector<ListedImage> images = list_files(options.images);
  if (options.pictures) check_picture_names(images);
  LandmarksRun run(options);
  nn::make_writable_folder(options.out);
  const Interruption interruption;  // until the results are written
  run.run(images);
}

}  // namespace

void add_landmarks_command(CLI::App& brain) {
  auto options = std::make_shared<LandmarksOptions>();
  CLI::App* command = brain.add_subcommand(
      "landmarks", "Find what a place is known by in images: regions, their class and their interest");
  command->add_option("images", options->images, "PNG, JPEG, PGM or BMP images, or folders of them")
      ->required();
  command->add_option("--out", options->out, "Folder for landmarks.json and the pictures; made if missing")
      ->required();
  add_interest_weights_option(command, options->weights);
  command->add_flag("!--no-pictures", options->pictures,
                    "Write landmarks.json alone, without NAME_overlay.png of each image");
  command
      ->add_option("--rarity", options->regions.interest.rarity,
                   "r of interest = score / n^r, where n regions of the image have the same class")
      ->capture_default_str()
      ->check(number_from(0.0, 4.0, "a number from 0 to 4"));
  command->add_flag("--join", options->regions.interest.join,
                    "Make one landmark of two small regions of different classes that touch");
  add_orientation_option(command, options->orientation);
  add_threads_option(command);
  add_isa_option(command);
  command->footer(
      "Examples:\n"
      "  penumbra brain landmarks out/street/sequences/00/image_0/000004.png --out out/found\n"
      "  penumbra brain landmarks out/street/sequences/00/image_0 --no-pictures --out out/found\n"
      "A picture shows the landmarks with their interest above and ORB features below. landmarks.json has "
      "class,\nscore, interest, box (x0, y0, x1, y1; pixels) and descriptor of each.");
  command->callback([options] { find_landmarks(*options); });
}

}  // namespace penumbra::apps
