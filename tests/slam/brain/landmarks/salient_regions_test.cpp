// Regions of hand-made grids of cells, drawn as text: a letter a class, another case another thing of it.
#include "slam/brain/landmarks/salient_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <string>

#include "tests/support/allocation_counter.h"

namespace penumbra::slam::brain {
namespace {

const std::map<char, int> kClassOf = {{'.', kNothing}, {'p', kPerson}, {'v', kVehicle}, {'s', kSign},
                                      {'l', kLamp},    {'t', kPlant},  {'f', kFacade}};

struct Drawing {
  explicit Drawing(const std::vector<std::string>& rows, float sure = 0.8F) {
    cells.width = static_cast<int>(rows.front().size());
    cells.height = static_cast<int>(rows.size());
    cells.size = 8.0F;
    cells.image_width = 8 * cells.width;
    cells.image_height = 8 * cells.height;
    for (const std::string& row : rows) {
      for (const char letter : row) {
        std::vector<float> p(kLandmarkClasses, (1.0F - sure) / (kLandmarkClasses - 1));
        p[static_cast<std::size_t>(kClassOf.at(static_cast<char>(std::tolower(letter))))] = sure;
        probabilities.insert(probabilities.end(), p.begin(), p.end());
        Descriptor e{};
        e[std::isupper(letter) != 0 ? 1 : 0] = 1.0F;
        embeddings.insert(embeddings.end(), e.begin(), e.end());
      }
    }
    cells.probabilities = probabilities;
    cells.embeddings = embeddings;
  }
  Drawing(const Drawing&) = delete;
  Drawing& operator=(const Drawing&) = delete;

  ImageCells cells;
  std::vector<float> probabilities, embeddings;
};

Landmarks regions_of(const std::vector<std::string>& rows, float sure = 0.8F,
                     const RegionSettings& settings = {}) {
  const Drawing drawing(rows, sure);
  Landmarks found;
  SalientRegions{settings}(drawing.cells, found);
  return found;
}

int count(const Landmarks& landmarks, int landmark_class) {
  return static_cast<int>(std::count_if(landmarks.begin(), landmarks.end(), [&](const Landmark& landmark) {
    return landmark.landmark_class == landmark_class;
  }));
}

// The example of docs/brain/interest.md: four lamps in a row, a sign, a car and its driver.
const std::vector<std::string> kStreet = {"............ss", "l..l..l..l..ss", "l..l..l..l....",
                                          "l..l..l..l.p..", "..........vvv.", "..........vvv."};

TEST(SalientRegions, IsTheExampleOfTheDocs) {
  const Landmarks found = regions_of(kStreet, 0.9F);
  ASSERT_EQ(found.size(), 5U);
  const Landmark& sign = found.front();
  EXPECT_EQ(sign.landmark_class, kSign);
  EXPECT_NEAR(sign.score, 0.9, 1e-6);
  EXPECT_NEAR(sign.interest, 0.9, 1e-6);
  EXPECT_EQ(sign.x0, 96.0F);
  EXPECT_EQ(sign.y0, 0.0F);
  EXPECT_EQ(sign.x1, 112.0F);
  EXPECT_EQ(sign.y1, 16.0F);
  EXPECT_NEAR(sign.descriptor[0], 1.0F, 1e-6F);
  for (std::size_t i = 1; i < found.size(); ++i) {
    EXPECT_EQ(found[i].landmark_class, kLamp);
    EXPECT_NEAR(found[i].interest, 0.45, 1e-6);
    EXPECT_EQ(found[i].x0, static_cast<float>(24 * (i - 1))) << "equal ones from left to right";
  }
}

TEST(SalientRegions, WhatMovesNeverBecomesALandmark) {
  EXPECT_TRUE(regions_of({"pppp", "pppp", "vvvv", "vvvv"}, 0.99F).empty());
  const Landmarks found = regions_of({"ssss", "spps", "spps", "vvvv"});
  EXPECT_EQ(found.size(), 1U) << "the cells before the sign are no part of it";
  EXPECT_EQ(count(found, kSign), 1);
}

// Green trousers that are more like a plant than like a person.
TEST(SalientRegions, WhatMayWellMoveDoesNotEither) {
  Drawing drawing({"tttt", "tttt"}, 0.6F);
  Landmarks found;
  SalientRegions regions;
  regions(drawing.cells, found);
  ASSERT_EQ(found.size(), 1U);
  for (std::size_t cell = 0; cell < 8; ++cell) {
    const auto p = drawing.probabilities.begin() + static_cast<std::ptrdiff_t>(cell * kLandmarkClasses);
    std::fill_n(p, kLandmarkClasses, 0.0F);
    p[kPlant] = 0.6F;
    p[kPerson] = 0.4F;
  }
  regions(drawing.cells, found);
  EXPECT_TRUE(found.empty());
}

TEST(SalientRegions, EndWhereAnotherThingOfTheClassBegins) {
  EXPECT_EQ(regions_of({"ffffff", "ffffff"}).size(), 1U);
  const Landmarks found = regions_of({"fffFFF", "fffFFF"});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_NEAR(found[0].interest, 0.8 / std::sqrt(2.0), 1e-6);
  EXPECT_EQ(std::min(found[0].x1, found[1].x1), 24.0F);
  // Cells that meet at their corners alone are two regions.
  EXPECT_EQ(regions_of({"tt..", "tt..", "..tt", "..tt"}).size(), 2U);
}

TEST(SalientRegions, SmallOnesAndUnsureCellsAreNone) {
  EXPECT_TRUE(regions_of({"s...", "s...", "...."}).empty());
  EXPECT_EQ(regions_of({"s...", "s...", "s..."}).size(), 1U);
  EXPECT_TRUE(regions_of({"ssss", "ssss"}, 0.39F).empty());
  RegionSettings smallest;
  smallest.least_cells = 1;
  EXPECT_EQ(regions_of({"s..."}, 0.8F, smallest).size(), 1U);
  EXPECT_TRUE(regions_of({"...."}).empty());
}

TEST(SalientRegions, TouchingOnesOfDifferentClassesJoinWhereAskedFor) {
  const std::vector<std::string> sign_on_post = {".ss.....", ".ss.....", ".ll....l", ".l.....l", ".l.....l"};
  EXPECT_EQ(regions_of(sign_on_post).size(), 3U);
  RegionSettings joining;
  joining.interest.join = true;
  const Landmarks found = regions_of(sign_on_post, 0.8F, joining);
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].landmark_class, kSign);
  EXPECT_EQ(found[0].y1, 40.0F);
  EXPECT_EQ(found[1].landmark_class, kLamp);
}

TEST(SalientRegions, BoxesStayInsideOfTheImage) {
  Drawing drawing({"ss", "ss"});
  drawing.cells.left = -3.0F;
  drawing.cells.top = 2.0F;
  drawing.cells.image_width = 10;
  drawing.cells.image_height = 20;
  Landmarks found;
  SalientRegions{}(drawing.cells, found);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].x0, 0.0F);
  EXPECT_EQ(found[0].x1, 10.0F);
  EXPECT_EQ(found[0].y0, 2.0F);
  EXPECT_EQ(found[0].y1, 18.0F);
}

TEST(SalientRegions, NumbersThatAreNoneMakeNoLandmark) {
  Drawing drawing({"ssss", "ssss"});
  for (float& p : drawing.probabilities) p = std::nanf("");
  Landmarks found;
  SalientRegions regions;
  regions(drawing.cells, found);
  EXPECT_TRUE(found.empty());
}

TEST(SalientRegions, AllocateNothingFromTheSecondImageOn) {
  const Drawing first(std::vector<std::string>(6, std::string(14, '.'))),
      second({"ff.FFF.ff.FF.f", "ff.FFF.ff.FF.f", "sss.sss.ss.sss", "tttttttttttttt", "llllll..llllll",
              "llllll..llllll"});
  SalientRegions regions;
  Landmarks found;
  regions(first.cells, found);
  const std::size_t before = test::allocation_count();
  regions(second.cells, found);
  EXPECT_EQ(test::allocation_count(), before);
  EXPECT_GT(found.size(), 7U);
}

}  // namespace
}  // namespace penumbra::slam::brain
