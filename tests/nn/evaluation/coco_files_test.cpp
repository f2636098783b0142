// COCO files that are wrong: every fault is named with file and entry; nothing crashes or hangs.
#include "tests/support/coco_files.h"

#include <gtest/gtest.h>

#include <random>

#include "nn/base/error.h"
#include "nn/evaluation/coco_rle.h"
#include "tests/support/bytes.h"
#include "tests/support/expect_error.h"

namespace penumbra::test {
namespace {

using nlohmann::json;

class CocoInput : public testing::Test {
 protected:
  CocoInput() : files_(2) {
    files_.add_object({10, 20, 30, 40}, 1);
    files_.add_object({5, 5, 100, 100}, 2, 7, true);
    files_.add_result({11, 20, 30, 40}, 0.75, 1);
    files_.add_result({6, 5, 60, 50}, 0.25, 2, 7);
    json& crowd = files_.annotations["annotations"][1]["segmentation"];
    crowd = {{"size", {300, 400}}, {"counts", {1000, 500, 118500}}};
    files_.results[1]["segmentation"] = {{"size", {300, 400}},
                                         {"counts", nn::encode_runs({1000, 400, 118600})}};
  }
  json& annotation() { return files_.annotations["annotations"][1]; }
  json& result() { return files_.results[1]; }

  // Expects an error whose message has all `parts` once the files are read.
  void expect(std::initializer_list<std::string> parts) {
    expect_error<InputError>([&] { files_.evaluate(nn::CocoRegion::masks); }, parts);
  }
  // The same where `value` stands at `key` of `entry` (missing where `value` is discarded).
  void expect_with(json& entry, const std::string& key, const json& value,
                   std::initializer_list<std::string> parts) {
    const json before = entry;
    if (value.is_discarded()) {
      entry.erase(key);
    } else {
      entry[key] = value;
    }
    SCOPED_TRACE(key + " " + (value.is_discarded() ? "missing" : value.dump()));
    expect(parts);
    entry = before;
  }

  CocoFiles files_;
  const json kMissing = json(json::value_t::discarded);
};

TEST_F(CocoInput, IsReadWhenItIsRight) { EXPECT_NO_THROW(files_.evaluate(nn::CocoRegion::masks)); }

TEST_F(CocoInput, MissingKeysAndWrongTypesNameTheEntry) {
  const std::string where = "instances.json: annotations, entry 1";
  for (const char* key : {"id", "image_id", "category_id", "bbox", "area"}) {
    // Where masks are compared, boxes may be missing.
    if (key != std::string("bbox")) {
      expect_with(annotation(), key, kMissing, {where, std::string("a key \"") + key + "\", found none"});
    }
    expect_with(annotation(), key, json::object(), {where, key, "found an object"});
  }
  for (const char* key : {"image_id", "category_id", "score"}) {
    expect_with(result(), key, kMissing, {"results.json: entry 1: expected a key", key});
    expect_with(result(), key, true, {std::string("results.json: entry 1, ") + key, "found true"});
  }
  expect_with(annotation(), "id", 1.5, {where + ", id: expected a whole number, found the number 1.5"});
  expect_with(annotation(), "iscrowd", "yes", {where + ", iscrowd: expected a number, found \"yes\""});
  expect_with(annotation(), "area", -1, {where + ", area: expected a number >= 0"});
  expect_with(files_.annotations["images"][1], "id", 1, {"images, entry 1, id", "1 a second time"});
  expect_with(files_.annotations["categories"][2], "id", 3, {"categories, entry 2, id", "3 a second time"});
  expect_with(annotation(), "id", 1, {where + ", id", "1 a second time"});
  expect_with(files_.annotations, "annotations", kMissing,
              {"instances.json: expected a list \"annotations\""});
  expect_with(files_.annotations, "images", json::object(), {"instances.json: images: expected a list"});
  expect_with(files_.annotations, "images", json::array({3}), {"images, entry 0: expected an object"});
}

// Only a polygon needs the image's size: boxes do not, and run lengths carry their own.
TEST_F(CocoInput, SidesThatNoImageHasMatterToPolygonsAlone) {
  json& image = files_.annotations["images"][1];
  for (const json& side : {json(0), json(-1), json(100.5), json("100"), json(1000000), json(nullptr)}) {
    image["width"] = side;
    EXPECT_NO_THROW(files_.evaluate(nn::CocoRegion::masks)) << side;
    EXPECT_NO_THROW(files_.evaluate(nn::CocoRegion::boxes)) << side;
  }
  result()["segmentation"] = {{1, 1, 9, 1, 9, 9}};
  expect({"results.json: entry 1, segmentation", "width and height of image 2", "found none"});
  EXPECT_NO_THROW(files_.evaluate(nn::CocoRegion::boxes));
  result()["segmentation"] = {{"size", {30, 40}}, {"counts", {100, 100, 1000}}};
  expect({"instances.json: image 2", "masks of one size", "40 x 30 and 400 x 300"});
}

TEST_F(CocoInput, IdsThatNameNothingAreErrors) {
  // Those of annotations, and categories of results, are left out with a count, as in the official tool.
  expect_with(result(), "image_id", "cat", {"results.json: entry 1, image_id", "found \"cat\""});
}

TEST_F(CocoInput, BoxesAreFourNumbersOfSensibleSize) {
  const std::string where = "results.json: entry 1, bbox";
  expect_with(result(), "bbox", {1, 2, 3}, {where, "found a list of 3"});
  expect_with(result(), "bbox", {1, 2, 3, "4"}, {where, "found \"4\""});
  expect_with(result(), "bbox", {1, 2, -3, 4}, {where, "width and height >= 0", "-3 x 4"});
  expect_with(result(), "bbox", {1, 2, 3, 1e300}, {where, "found the number 1e+300"});
  result().erase("segmentation");
  expect_with(result(), "bbox", nullptr, {where, "expected a box or a segmentation, found neither"});
}

TEST_F(CocoInput, SegmentationsAreOneOfThreeForms) {
  const std::string where = "results.json: entry 1, segmentation";
  const auto runs = [](const json& size, const json& counts) {
    return json{{"size", size}, {"counts", counts}};
  };
  const json size = {300, 400};
  expect_with(result(), "segmentation", "mask", {where, "found \"mask\""});
  expect_with(result(), "segmentation", {{1, 2, 3, 4}}, {where + ", polygon 0", "found 4"});
  expect_with(result(), "segmentation", {{1, 2, 3, 4, 5, 6, 7}}, {where + ", polygon 0", "found 7"});
  expect_with(result(), "segmentation", {{1, 2, 3, 4, 5, "6"}}, {where + ", polygon 0", "found \"6\""});
  expect_with(result(), "segmentation", {{1, 2, 3, 4, 5, 1e9}}, {where + ", polygon 0", "coordinates"});
  expect_with(result(), "segmentation", {1, 2, 3, 4, 5, 6}, {where + ", polygon 0", "found the number 1"});
  expect_with(result(), "segmentation", {{"size", size}}, {where, "only some of them"});
  expect_with(result(), "segmentation", runs({300}, {120000}), {where + ", size", "a list of 1"});
  expect_with(result(), "segmentation", runs({300, -1}, {120000}), {where + ", size", "the number -1"});
  expect_with(result(), "segmentation", runs({300, 70000}, {120000}), {where + ", size", "70000"});
  expect_with(result(), "segmentation", runs({400, 300}, {120000}), {where + ", size", "[300, 400]"});
  expect_with(result(), "segmentation", runs(size, {100, 20}), {where + ", counts", "120000", "found 120"});
  expect_with(result(), "segmentation", runs(size, {100, -20}), {where + ", counts", "the number -20"});
  expect_with(result(), "segmentation", runs(size, {4294967296}), {where + ", counts", "4294967296"});
  expect_with(result(), "segmentation", runs(size, 7), {where + ", counts", "a list or a text"});
  expect_with(result(), "segmentation", runs(size, "~~"), {where + ", counts", "run-length code"});
  expect_with(result(), "segmentation", runs(size, "T3"), {where + ", counts", "120000", "found 100"});
  expect_with(result(), "segmentation", runs(size, ""), {where + ", counts", "found 0"});
}

TEST_F(CocoInput, TextThatIsNotJsonNamesTheByteAndTheEntry) {
  files_.write();
  const nn::CocoAnnotations truth = nn::read_coco_annotations(files_.annotations_path());
  const auto expect_text = [&](const std::string& text, std::initializer_list<std::string> parts) {
    SCOPED_TRACE(text.substr(0, 60));
    write_file(files_.results_path(), text);
    expect_error<InputError>([&] { nn::read_coco_results(files_.results_path(), truth); }, parts);
  };
  expect_text("", {"results.json", "well-formed JSON"});
  expect_text("{}", {"results.json: expected a list of entries, found an object"});
  expect_text("7", {"results.json: expected a list of entries, found the number 7"});
  expect_text("[7]", {"results.json: entry 0: expected an object, found the number 7"});
  expect_text("[{\"score\": NaN}]", {"results.json: entry 0, byte", "well-formed JSON"});
  expect_text("[{\"score\": 1e999}]", {"results.json: entry 0, byte"});
  expect_text("[{\"score\": 1, \"score\": 2}]", {"entry 0: expected every key once, found \"score\" twice"});
  expect_text("[] trailing", {"results.json", "byte", "well-formed JSON"});
  expect_text(std::string("[]\0[]", 5), {"results.json, byte 2", "a zero byte"});
  expect_text(std::string(100000, '['), {"results.json: entry 0: expected nesting of at most 32 levels"});
  std::string objects;
  for (int i = 0; i < 100000; ++i) objects += "{\"a\":";
  expect_text("[" + objects, {"nesting of at most 32 levels"});
  write_file(files_.annotations_path(), "{\"info\": " + objects);
  expect_error<InputError>([&] { nn::read_coco_annotations(files_.annotations_path()); },
                           {"instances.json: info: expected nesting of at most 32 levels"});
  write_file(files_.annotations_path(), "[]");
  expect_error<InputError>([&] { nn::read_coco_annotations(files_.annotations_path()); },
                           {"instances.json: expected an object, found a list"});
  expect_error<InputError>([&] { nn::read_coco_annotations("/no/such/file.json"); }, {"/no/such/file.json"});
}

TEST_F(CocoInput, EveryTruncationAndManyFlippedBitsAreReadOrRefused) {
  files_.write();
  for (const std::string& path : {files_.annotations_path(), files_.results_path()}) {
    const std::string whole = read_file(path);
    const auto attempt = [&](const std::string& text) {
      write_file(path, text);
      try {
        const nn::CocoAnnotations truth = nn::read_coco_annotations(files_.annotations_path());
        nn::evaluate_coco(truth, nn::read_coco_results(files_.results_path(), truth), nn::CocoRegion::masks);
        return true;
      } catch (const InputError&) {
        return false;
      }
    };
    for (std::size_t size = 0; size < whole.size(); size += 64) EXPECT_FALSE(attempt(whole.substr(0, size)));
    std::mt19937 random(3);
    for (int trial = 0; trial < 1000; ++trial) {
      std::string damaged = whole;
      for (unsigned i = 0, flips = 1 + random() % 3; i < flips; ++i) {
        damaged[random() % damaged.size()] ^= static_cast<char>(1U << random() % 8);
      }
      attempt(damaged);
    }
    EXPECT_TRUE(attempt(whole));
  }
}

TEST_F(CocoInput, SectionsMayStandInAnyOrderAndOthersAreSkipped) {
  files_.write();
  std::string text = "{\"info\": {\"deep\": [[{\"a\": 1}]]}, \"licenses\": [1, [2]], \"annotations\": " +
                     files_.annotations["annotations"].dump() +
                     ", \"images\": " + files_.annotations["images"].dump() +
                     ", \"categories\": " + files_.annotations["categories"].dump() + "}";
  write_file(files_.annotations_path(), text);
  EXPECT_EQ(nn::read_coco_annotations(files_.annotations_path()).annotations.size(), 2U);
  EXPECT_EQ(nn::read_coco_images(files_.annotations_path()).images.size(), 2U);
  text.insert(1, "\"images\": [], ");
  write_file(files_.annotations_path(), text);
  expect_error<InputError>([&] { nn::read_coco_annotations(files_.annotations_path()); },
                           {"expected every section once, found \"images\" twice"});
}

TEST_F(CocoInput, ImagesMayBeNamedInsteadOfNumbered) {
  CocoFiles files;
  files.annotations["images"][0]["id"] = "street \"7\"";
  files.add_object({0, 0, 20, 20});
  files.annotations["annotations"][0]["image_id"] = "street \"7\"";
  files.write();
  const nn::CocoAnnotations truth = nn::read_coco_annotations(files.annotations_path());
  nn::CocoResultsWriter writer;
  nn::Detection detection{{0, 0, 20, 20}, 0.5F, 1, {0, 0, 20, 20, std::vector<std::uint8_t>(400, 1)}};
  writer.add(truth.images[0].id, 1, detection, 400, 300);
  detection.box = {100.25F, 50.5F, 110, 60};
  detection.mask = {};
  writer.add(truth.images[0].id, 1, detection, 400, 300);
  writer.write(files.results_path());
  const nn::CocoResults results = nn::read_coco_results(files.results_path(), truth);
  ASSERT_EQ(results.results.size(), 2U);
  EXPECT_EQ(results.results[1].box, (nn::CocoBox{100.25, 50.5, 9.75, 9.5}));
  EXPECT_NEAR(nn::evaluate_coco(truth, results, nn::CocoRegion::masks)["AP"], 1.0, 1e-12);
}

}  // namespace
}  // namespace penumbra::test
