#include "nn/models/class_names.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/models/coco_categories.h"
#include "tests/support/expect_error.h"

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

// YOLO has no background: of one name too many nobody knows which, and class 0 must not take the second.
TEST(ClassNames, ANetworkWithoutBackgroundHasOneNameAnOutput) {
  StateDict weights;
  weights.metadata["classes"] = "cat, dog";
  EXPECT_EQ(class_names(weights, 3, {}, false), (std::vector<std::string>{"background", "cat", "dog"}));
  weights.metadata["classes"] = "background, cat, dog";
  EXPECT_EQ(class_names(weights, 3, {}, false)[1], "cat");
  weights.metadata["classes"] = "cat, dog, cow";
  EXPECT_EQ(class_names(weights, 3, {}, true)[1], "dog") << "the first is the background's";
  test::expect_error<InputError>([&] { class_names(weights, 3, {}, false); },
                                 {"metadata classes", "2 class names", "found 3"});
  test::expect_error<InputError>([&] { class_names(weights, 91, {}, false); }, {"80 class names"});
}

}  // namespace
}  // namespace penumbra::nn
