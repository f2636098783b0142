#include "weights_tools/load_weights.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"

namespace penumbra::weights_tools {
namespace {

TEST(LoadWeights, MissingFileIsAnInputError) { EXPECT_THROW(load_weights("/no/such/file"), InputError); }

}  // namespace
}  // namespace penumbra::weights_tools
