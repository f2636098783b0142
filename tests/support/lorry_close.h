// The street's preset `lorry-close`, driven without masks and with exact ones.
#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "nn/base/file.h"
#include "tests/support/test_data.h"

namespace penumbra::test {

struct LorryCloseErrors {
  double none = 0.0, truth = 0.0;  // metres, ATE
};

inline LorryCloseErrors drive_behind_close_lorry(int seed, int frames) {
  const TemporaryDirectory folder;
  const ProgramResult result = run_penumbra(
      fmt::format("ablate --presets lorry-close --frames {} --seeds {} --masks none,truth --out '{}'", frames,
                  seed, (folder / "out").string()));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto error_of = [&](const char* masks) {
    const auto file =
        folder / fmt::format("out/cells/lorry-close_620x188_{}_seed{}_{}_adaptive.json", frames, seed, masks);
    return nlohmann::json::parse(nn::read_file(file, "a cell")).at("ate_m").get<double>();
  };
  return {error_of("none"), error_of("truth")};
}

}  // namespace penumbra::test
