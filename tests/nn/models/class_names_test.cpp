#include "nn/models/class_names.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/models/coco_categories.h"

namespace penumbra::nn {
namespace {

TEST(ClassNames, EightyNamesGoToCocosNumbers) {
  StateDict weights;
  std::string names;
  for (int c = 0; c < kCocoClasses; ++c) names += fmt::format("thing-{}\n", c);
  weights.metadata["classes"] = names;
  const std::vector<std::string> spread = class_names(weights, 91, {});
  EXPECT_EQ(spread[1], "thing-0");
  EXPECT_EQ(spread[13], "thing-11") << "12 is a gap";
  EXPECT_EQ(spread[90], "thing-79");
  const std::vector<std::string> coco = class_names({}, 91, {});
  EXPECT_EQ(coco[static_cast<std::size_t>(category_of_class(2, kCocoClasses))], "car");
  EXPECT_EQ(coco[static_cast<std::size_t>(category_of_class(79, kCocoClasses))], "toothbrush");
}

TEST(ClassNames, AClassifiersListHasOneNameAnOutput) {
  StateDict weights;
  EXPECT_EQ(output_names(weights, 2, {}), (std::vector<std::string>{"class 0", "class 1"}));
  weights.metadata["classes"] = "cat, dog";
  EXPECT_EQ(output_names(weights, 2, {}), (std::vector<std::string>{"cat", "dog"}));
  EXPECT_THROW(output_names(weights, 3, {}), InputError) << "no background is added";
}

}  // namespace
}  // namespace penumbra::nn
