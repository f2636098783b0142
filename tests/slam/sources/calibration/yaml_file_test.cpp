#include "slam/sources/calibration/yaml_file.h"

#include <gtest/gtest.h>

#include "nn/base/error.h"
#include "nn/base/file.h"
#include "tests/support/expect_error.h"
#include "tests/support/test_data.h"

namespace penumbra::slam {
namespace {

using test::expect_error;

class Yaml : public testing::Test {
 protected:
  YamlFile read(const std::string& text) const {
    nn::write_file(folder_ / "camera.yaml", text);
    return YamlFile(folder_ / "camera.yaml");
  }
  void expect_refused(const std::string& text, std::initializer_list<std::string> parts) const {
    SCOPED_TRACE(text);
    expect_error<InputError>([&] { read(text); }, parts);
  }
  test::TemporaryDirectory folder_;
};

TEST_F(Yaml, ReadsASensorFileOfEuroc) {
  const YamlFile yaml = read(
      "%YAML:1.0\n---\n# General definitions.\nsensor_type: camera\ncomment: VI-Sensor cam0 (MT9M034)\n\n"
      "T_BS:\n  cols: 2\n  rows: 2\n  data: [1.5, -2e-3,\n         0.25,\t4]\r\n\n"
      "intrinsics: [458.654, 457.296] #fu, fv\nname: 'a # b' # quoted\n");
  EXPECT_EQ(yaml.text("sensor_type"), "camera");
  EXPECT_EQ(yaml.text("comment"), "VI-Sensor cam0 (MT9M034)");
  EXPECT_EQ(yaml.number("T_BS.cols"), 2.0);
  EXPECT_EQ(yaml.numbers("T_BS.data"), (std::vector<double>{1.5, -2e-3, 0.25, 4.0}));
  EXPECT_EQ(yaml.numbers("intrinsics", 2).back(), 457.296);
  EXPECT_EQ(yaml.text("name"), "a # b");
  EXPECT_TRUE(yaml.has("T_BS"));
  EXPECT_FALSE(yaml.has("T_B"));
  EXPECT_NE(yaml.place("T_BS.data").find("camera.yaml:10 (T_BS.data)"), std::string::npos);
}

TEST_F(Yaml, ReadsRowsTagsAndDeeperKeys) {
  const YamlFile yaml = read(
      "a:\n- [1, 2]\n- [3, 4]\ncam0:\n  K: !!opencv-matrix\n    rows: 1\n    data: [ 7, ]\n  empty: []\nb: "
      "true\n");
  EXPECT_EQ(yaml.numbers("a"), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(yaml.number("cam0.K.data"), 7.0);
  EXPECT_TRUE(yaml.numbers("cam0.empty").empty());
  EXPECT_TRUE(yaml.flag("b"));
  EXPECT_EQ(yaml.number_or("c", 5.0), 5.0);
  EXPECT_EQ(yaml.text_or("c", "none"), "none");
}

TEST_F(Yaml, ReadsListsAndMapsAsPythonWritesThem) {
  const YamlFile yaml = read(
      "a:\n- 185.6\n- -2e-3\nb:\n  c:\n  - - 1.0\n    - 0.0\n  - - 0.0\n    - 1.0\n"
      "K: [[1, 0, 2],\n    [0, 3, 4]] # rows\nleft: {fx: 1.5, \"model\": 'a, b',\n  size: [2, 3], in: {x: "
      "7}}\n"
      "d: {}\n");
  EXPECT_EQ(yaml.numbers("a"), (std::vector<double>{185.6, -2e-3}));
  EXPECT_EQ(yaml.numbers("b.c"), (std::vector<double>{1, 0, 0, 1}));
  EXPECT_EQ(yaml.numbers("K"), (std::vector<double>{1, 0, 2, 0, 3, 4}));
  EXPECT_EQ(yaml.number("left.fx"), 1.5);
  EXPECT_EQ(yaml.text("left.model"), "a, b");
  EXPECT_EQ(yaml.numbers("left.size"), (std::vector<double>{2, 3}));
  EXPECT_EQ(yaml.number("left.in.x"), 7.0);
  EXPECT_NE(yaml.place("left.size").find("camera.yaml:13 (left.size)"), std::string::npos);
  EXPECT_TRUE(yaml.has_value("d"));
  expect_refused("a: [{b: 1}]\n", {"camera.yaml:1", "a map in a list"});
  expect_refused("a: [[1, [2]]]\n", {"camera.yaml:1", "a list in a row"});
  expect_refused("a: [1] [2]\n", {"camera.yaml:1", "one list"});
  expect_refused("a: {b: 1\n", {"camera.yaml:1", "no end"});
  expect_refused("a: {b}\n", {"camera.yaml:1", "{key: value, ...}", "'b'"});
  expect_refused("a: {b: 1, b: 2}\n", {"camera.yaml:1", "every key once", "'a.b'"});
  expect_refused("a: [1]\n- 2\n", {"camera.yaml:2", "a key"});
  expect_refused("a:\n-2\n", {"camera.yaml:2", "a row"});
}

TEST_F(Yaml, RefusesWhatItDoesNotUnderstandWithItsLine) {
  expect_refused("a: 1\nb\n", {"camera.yaml:2", "'key: value'", "'b'"});
  expect_refused("a: 1\na: 2\n", {"camera.yaml:2", "every key once", "'a'"});
  expect_refused("a:\n\tb: 1\n", {"camera.yaml:2", "a tab"});
  expect_refused("a: [1, 2\nb: 3\n", {"camera.yaml:1", "ends with ']'"});
  expect_refused("a: [1, [2]]\n", {"camera.yaml:1"});
  expect_refused("a: [1] 2\n", {"camera.yaml:1", "the end of the line", "'2'"});
  expect_refused("a: |\n  text\n", {"camera.yaml:1", "a number"});
  expect_refused("- [1, 2]\n", {"camera.yaml:1", "a key"});
  expect_refused("a: 1\n- [1]\n", {"camera.yaml:2", "a key"});
  expect_refused("a:\n- b\n", {"camera.yaml:2", "a row"});
  expect_refused(": 1\n", {"a key"});
  std::string deep;
  for (std::size_t d = 0; d < 20; ++d) deep += std::string(d, ' ') + "k:\n";
  expect_refused(deep, {"levels deep"});
}

TEST_F(Yaml, SaysWhatIsWrongWithAValue) {
  const YamlFile yaml = read("a: 1 2\nb: word\nc: nan\nd: 0\ne: [1]\n");
  expect_error<InputError>([&] { yaml.number("a"); }, {"camera.yaml:1 (a)", "1 number", "2"});
  expect_error<InputError>([&] { yaml.number("b"); }, {"camera.yaml:2 (b)", "a number", "'word'"});
  expect_error<InputError>([&] { yaml.number("c"); }, {"a finite number", "nan"});
  expect_error<InputError>([&] { yaml.number_above_zero("d"); }, {"above 0"});
  expect_error<InputError>([&] { yaml.text("e"); }, {"a word", "a list"});
  expect_error<InputError>([&] { yaml.flag("b"); }, {"true or false", "'word'"});
  expect_error<InputError>([&] { yaml.number("fx"); }, {"camera.yaml", "the key fx", "no such key"});
}

}  // namespace
}  // namespace penumbra::slam
