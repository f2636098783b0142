#include "slam/evaluation/matching_plot.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "nn/base/error.h"
#include "slam/evaluation/plot_canvas.h"

namespace penumbra::slam {

namespace {

// Final pixels.
constexpr int kWidth = 1200, kTop = 110, kPanel = 330, kGap = 70, kBottom = 60, kLeft = 120, kRight = 40;

constexpr Bgr kEffective{178, 114, 0}, kWrong{0, 94, 213};

using Bin = DisplacementHistogram::Bin;

// Bins up to the last that matters: all but a thousandth of the pairs.
std::size_t shown_bins(const std::vector<HistogramPanel>& panels) {
  std::size_t shown = 10;
  for (const HistogramPanel& panel : panels) {
    double total = 0.0, beyond = 0.0;
    const auto count = [](const Bin& b) {
      return static_cast<double>(b.effective_kept + b.effective_removed + b.wrong_kept + b.wrong_removed);
    };
    const auto& bins = panel.histogram.bins;
    for (const Bin& bin : bins) total += count(bin);
    std::size_t last = bins.size();
    while (last > 1 && beyond + count(bins[last - 1]) <= 1e-3 * total) beyond += count(bins[--last]);
    shown = std::max(shown, last);
  }
  return shown;
}

void draw_panel(PlotCanvas& canvas, const HistogramPanel& panel, double top, std::size_t shown) {
  const double width = kWidth - kLeft - kRight, bar = width / static_cast<double>(shown);
  double most = 1.0;
  for (const Bin& b : panel.histogram.bins) {
    most = std::max(
        {most, std::sqrt(b.effective_kept + b.wrong_kept), std::sqrt(b.effective_removed + b.wrong_removed)});
  }
  const double middle = top + 0.62 * kPanel, up = 0.6 * kPanel / most, down = 0.36 * kPanel / most;
  const auto draw_bar = [&](std::size_t i, double from, double to, const Bgr& colour) {
    if (from == to) return;
    const double x = kLeft + bar * static_cast<double>(i);
    canvas.box({x + 0.08 * bar, from}, {x + 0.92 * bar, to}, colour);
  };
  for (std::size_t i = 0; i < shown; ++i) {
    const Bin& b = panel.histogram.bins[i];
    // The whole bar is as high as the root of the count; effective and wrong share it as they share the
    // pairs.
    const auto part = [](int a, int all) { return all > 0 ? a / std::sqrt(static_cast<double>(all)) : 0.0; };
    const int kept = b.effective_kept + b.wrong_kept, removed = b.effective_removed + b.wrong_removed;
    const double e = middle - up * part(b.effective_kept, kept);
    draw_bar(i, middle, e, kEffective);
    draw_bar(i, e, e - up * part(b.wrong_kept, kept), kWrong);
    const double r = middle + down * part(b.effective_removed, removed);
    draw_bar(i, middle, r, kEffective);
    draw_bar(i, r, r + down * part(b.wrong_removed, removed), kWrong);
  }
  canvas.line({kLeft, middle}, {kWidth - kRight, middle}, 1.0, kInk);
  canvas.text(panel.title, {kLeft, top - 14}, 15, Anchor::left, kInk, true);
  canvas.text("kept", {kLeft - 12, middle - 0.3 * kPanel}, 13, Anchor::right, kInk);
  canvas.text("removed", {kLeft - 12, middle + 0.2 * kPanel}, 13, Anchor::right, kInk);
  const double step = round_step(90.0 / bar * DisplacementHistogram::kWidth);
  for (double x = 0.0; x <= static_cast<double>(shown) * DisplacementHistogram::kWidth; x += step) {
    const double column = kLeft + x / DisplacementHistogram::kWidth * bar;
    canvas.text(fmt::format("{:g}", x), {column, top + kPanel + 18}, 12, Anchor::centre, kFaintInk);
  }
}

}  // namespace

PlotCanvas draw_displacements(const std::string& title, const std::vector<HistogramPanel>& panels) {
  if (panels.empty()) throw Error("cannot draw no histogram");
  const int height = kTop + static_cast<int>(panels.size()) * (kPanel + kGap) + kBottom;
  PlotCanvas canvas(kWidth, height);
  canvas.text(title, {kLeft, 36}, 18, Anchor::left, kInk, true);
  double x = kLeft;
  for (const auto& [name, colour] : {std::pair("effective", kEffective), std::pair("wrong", kWrong)}) {
    canvas.box({x, 52}, {x + 18, 66}, colour);
    canvas.text(name, {x + 26, 65}, 13, Anchor::left, kInk);
    x += 60 + text_width(name, 13);
  }
  canvas.text("height: square root of the number of pairs", {x + 10, 65}, 13, Anchor::left, kFaintInk);
  const std::size_t shown = shown_bins(panels);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    draw_panel(canvas, panels[p], kTop + static_cast<double>(p) * (kPanel + kGap), shown);
  }
  canvas.text("how far the features of a pair moved (pixels)", {0.5 * kWidth, height - 28.0}, 14,
              Anchor::centre, kInk);
  return canvas;
}

}  // namespace penumbra::slam
