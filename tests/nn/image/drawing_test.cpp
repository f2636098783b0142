#include "nn/image/drawing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

#include "nn/image/stroke_font.h"

namespace penumbra {
namespace {

constexpr Bgr kRed{0, 0, 255};

ByteImage paper(int width, int height) { return ByteImage::filled(width, height, 255, 3); }

// How much of the picture a shape covers, pixels: red leaves the blue channel in proportion.
double covered(const ByteImage& picture) {
  double sum = 0.0;
  for (int y = 0; y < picture.height(); ++y) {
    for (int x = 0; x < picture.width(); ++x) sum += 1.0 - picture.at(x, y, 0) / 255.0;
  }
  return sum;
}

TEST(Drawing, ShapesCoverTheirAreas) {
  ByteImage disc = paper(60, 60), line = paper(60, 60), box = paper(60, 60), frame = paper(60, 60);
  draw_disc(disc, {30.2, 29.7}, 12.0, kRed);
  EXPECT_NEAR(covered(disc), 144.0 * std::acos(-1.0), 3.0);
  draw_line(line, {10.0, 10.0}, {40.0, 50.0}, 4.0, kRed);
  EXPECT_NEAR(covered(line), 4.0 * 50.0 + 4.0 * std::acos(-1.0), 3.0);
  draw_box(box, {40.0, 50.0}, {10.0, 20.0}, kRed);
  EXPECT_NEAR(covered(box), 900.0, 2.0);
  draw_box(frame, {10.0, 20.0}, {40.0, 50.0}, kRed, 2.0);
  EXPECT_NEAR(covered(frame), 2.0 * 120.0, 4.0);
  EXPECT_EQ(disc.at(30, 30, 2), 255);
  EXPECT_EQ(disc.at(30, 30, 0), 0);
}

TEST(Drawing, WhatLiesOutsideIsLeftOut) {
  ByteImage picture = paper(20, 10);
  draw_disc(picture, {-1e9, 1e9}, 5.0, kRed);
  draw_line(picture, {-50.0, 5.0}, {1e7, 5.0}, 2.0, kRed);
  draw_polyline(picture, {}, 2.0, kRed);
  draw_text(picture, "beyond", {15.0, 100.0}, 12.0, kRed);
  EXPECT_NEAR(covered(picture), 40.0, 1.0);
}

TEST(Drawing, EveryGlyphHasStrokesOfItsOwn) {
  std::set<std::string> seen;
  for (char letter = '!'; letter <= '~'; ++letter) {
    const Glyph glyph = glyph_of(letter);
    EXPECT_GT(glyph.advance, 1.0) << letter;
    seen.insert(std::string(glyph.strokes));
    int strokes = 0;
    for_each_stroke(glyph, [&](int x0, int y0, int x1, int y1) {
      ++strokes;
      for (const int x : {x0, x1}) EXPECT_TRUE(x >= 0 && x <= 4) << letter;
      for (const int y : {y0, y1}) EXPECT_TRUE(y >= -2 && y <= 6) << letter;
    });
    EXPECT_GT(strokes, 0) << letter;
  }
  EXPECT_GE(seen.size(), 92U);  // O and 0 differ; S and 5, too
  EXPECT_EQ(glyph_of('\xE4').strokes, glyph_of('?').strokes);
}

TEST(Drawing, TextIsAsWideAsItSays) {
  ByteImage picture = paper(200, 40);
  draw_text(picture, "HXH", {10.0, 30.0}, 18.0, kRed);
  int left = 200, right = 0, top = 40;
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 200; ++x) {
      if (picture.at(x, y, 0) > 128) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      top = std::min(top, y);
    }
  }
  EXPECT_NEAR(left, 10, 2);
  EXPECT_NEAR(top, 12, 2);
  EXPECT_NEAR(right, 10.0 + text_width("HXH", 18.0), 9.0);  // the space behind the last letter
}

}  // namespace
}  // namespace penumbra
