#include "nn/io/safetensors.h"

#include <gtest/gtest.h>

#include <cstring>

#include "nn/base/error.h"
#include "tests/support/bytes.h"
#include "tests/support/test_data.h"

namespace penumbra::nn {
namespace {

using test::little_endian;
using test::message_of;
using test::write_file;

class Safetensors : public ::testing::Test {
 protected:
  // A file with this header and `data_size` zero bytes of data.
  std::filesystem::path file(const std::string& header, std::size_t data_size = 0) {
    write_file(folder_ / "file",
               little_endian<std::uint64_t>(header.size()) + header + std::string(data_size, '\0'));
    return folder_ / "file";
  }
  // Why a file with this header is refused.
  std::string refusal(const std::string& header, std::size_t data_size = 0) {
    const std::filesystem::path path = file(header, data_size);
    const std::string message = message_of<InputError>([&] { read_safetensors(path); });
    EXPECT_CONTAINS(message, path.string());
    return message;
  }

  test::TemporaryDirectory folder_;
};

StoredTensor tensor(DataType type, std::vector<std::int64_t> shape, const std::string& bytes) {
  return {type, std::move(shape), test::as_bytes(bytes)};
}

TEST_F(Safetensors, WhatIsWrittenIsReadBack) {
  StateDict state;
  const std::string three = "abc", two = "01", eight = "ABCDEFGH", four = "wxyz";
  state.tensors["u8"] = tensor(DataType::u8, {3}, three);
  state.tensors["bool"] = tensor(DataType::boolean, {1, 2}, two);
  state.tensors["f64"] = tensor(DataType::f64, {}, eight);
  state.tensors["bf16"] = tensor(DataType::bf16, {2}, four);
  state.tensors["empty"] = tensor(DataType::f32, {0, 5}, "");
  state.tensors["name \xC3\xA4 \"quoted\"\n"] = tensor(DataType::f32, {1}, four);
  state.metadata = {{"batch_norm_eps", "0"}, {"classes", "person, car"}};
  write_safetensors(folder_ / "out", state);

  const StateDict read = read_safetensors(folder_ / "out");
  EXPECT_EQ(read.metadata, state.metadata);
  EXPECT_EQ(read.source, (folder_ / "out").string());
  ASSERT_EQ(read.tensors.size(), state.tensors.size());
  for (const auto& [name, expected] : state.tensors) {
    const StoredTensor& found = read.tensors.at(name);
    EXPECT_EQ(found.type, expected.type);
    EXPECT_EQ(found.shape, expected.shape);
    EXPECT_EQ(test::to_hex(found.bytes), test::to_hex(expected.bytes));
    if (!found.bytes.empty()) {
      EXPECT_EQ(reinterpret_cast<std::uintptr_t>(found.bytes.data()) % size_of(found.type), 0U) << name;
    }
  }
  // Only the finished file is in the folder, and it is the same each time.
  const std::string first = test::read_file(folder_ / "out");
  write_safetensors(folder_ / "out", read);
  EXPECT_EQ(test::read_file(folder_ / "out"), first);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(Safetensors, NoTensorsAndNoMetadataAreAValidFile) {
  write_safetensors(folder_ / "out", {});
  EXPECT_TRUE(read_safetensors(folder_ / "out").tensors.empty());
  EXPECT_TRUE(read_safetensors(file("{}")).tensors.empty());
}

TEST_F(Safetensors, TheTensorsOutliveTheStateDictTheyWereCopiedFrom) {
  StateDict copy;
  copy = read_safetensors(file(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", 8));
  std::filesystem::remove(folder_ / "file");
  EXPECT_EQ(copy.tensors.at("a").to_f32(), (std::vector<float>{0.0F, 0.0F}));
}

TEST_F(Safetensors, AHeaderLengthBeyondTheFileIsRefused) {
  write_file(folder_ / "file", little_endian(std::uint64_t{1} << 63) + "{}");
  EXPECT_CONTAINS(message_of<InputError>([&] { read_safetensors(folder_ / "file"); }), "9223372036854775808");
  write_file(folder_ / "file", little_endian(~std::uint64_t{0}) + "{}");
  EXPECT_THROW(read_safetensors(folder_ / "file"), InputError);
  write_file(folder_ / "file", little_endian(std::uint64_t{3}) + "{}");
  EXPECT_CONTAINS(message_of<InputError>([&] { read_safetensors(folder_ / "file"); }), "ends after 2");
  for (const std::size_t length : {0, 1, 7}) {
    write_file(folder_ / "file", std::string(length, '\1'));
    EXPECT_THROW(read_safetensors(folder_ / "file"), InputError);
  }
  EXPECT_THROW(read_safetensors(folder_ / "no such file"), InputError);
}

TEST_F(Safetensors, AHeaderThatIsNotJsonIsRefused) {
  EXPECT_CONTAINS(refusal(""), "byte 8");
  EXPECT_CONTAINS(refusal("[]"), "byte 8");
  EXPECT_CONTAINS(refusal("{\"a\":"), "well-formed JSON");
  EXPECT_CONTAINS(refusal("{} x"), "well-formed JSON");
  EXPECT_CONTAINS(refusal("{\"a\xFF\":1}"), "well-formed JSON");
  EXPECT_CONTAINS(refusal(std::string("{}\0", 3)), "well-formed JSON");
}

TEST_F(Safetensors, DeepNestingIsRefusedWithoutACrash) {
  const std::size_t depth = 10'000'000;
  EXPECT_CONTAINS(refusal(R"({"a":)" + std::string(depth, '[')), "an array");
  std::string objects;
  for (int i = 0; i < 1'000'000; ++i) objects += R"({"a":)";
  refusal(objects);
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":)" + std::string(depth, '[')), "an array");
}

TEST_F(Safetensors, StructureOtherThanTheFormatsIsRefused) {
  EXPECT_CONTAINS(refusal(R"({"a":1})"), "\"a\"");
  EXPECT_CONTAINS(refusal(R"({"a":null})"), "null");
  EXPECT_CONTAINS(refusal(R"({"a":{}})"), "only some");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":[1]}})", 4), "only some");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F33","shape":[1],"data_offsets":[0,4]}})", 4), "F33");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":7,"shape":[1],"data_offsets":[0,4]}})", 4), "dtype");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":[-1],"data_offsets":[0,4]}})", 4), "-1");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":[1.0],"data_offsets":[0,4]}})", 4), "1.0");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":["1"],"data_offsets":[0,4]}})", 4), "a string");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":1,"data_offsets":[0,4]}})", 4), "shape");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[4]}})", 4), "two data_offsets");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4,4]}})", 4),
                  "two data_offsets");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","shape":[1],"data_offsets":[0,4],"x":1}})", 4), "\"x\"");
  EXPECT_CONTAINS(refusal(R"({"__metadata__":{"a":1}})"), "a string");
  EXPECT_CONTAINS(refusal(R"({"__metadata__":["a"]})"), "an array");
}

TEST_F(Safetensors, NamesThatStandTwiceAreRefused) {
  const std::string a = R"("a":{"dtype":"F32","shape":[1],"data_offsets":[0,4]})";
  EXPECT_CONTAINS(refusal("{" + a + "," + a + "}", 4), "twice");
  EXPECT_CONTAINS(refusal(R"({"__metadata__":{"k":"1","k":"2"}})"), "twice");
  EXPECT_CONTAINS(refusal(R"({"__metadata__":{},"__metadata__":{}})"), "twice");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"F32","dtype":"F32","shape":[1],"data_offsets":[0,4]}})", 4),
                  "twice");
}

TEST_F(Safetensors, OffsetsThatDoNotTileTheDataAreRefused) {
  const auto two = [](int a0, int a1, int b0, int b1) {
    return fmt::format(R"({{"a":{{"dtype":"U8","shape":[{}],"data_offsets":[{},{}]}},)"
                       R"("b":{{"dtype":"U8","shape":[{}],"data_offsets":[{},{}]}}}})",
                       a1 - a0, a0, a1, b1 - b0, b0, b1);
  };
  EXPECT_NO_THROW(read_safetensors(file(two(0, 4, 4, 8), 8)));
  EXPECT_NO_THROW(read_safetensors(file(two(4, 8, 0, 4), 8)));
  EXPECT_CONTAINS(refusal(two(0, 4, 2, 8), 8), "begin at offset 4");  // overlap
  EXPECT_CONTAINS(refusal(two(0, 8, 0, 8), 8), "begin at offset 8");  // the same bytes twice
  EXPECT_CONTAINS(refusal(two(0, 4, 5, 8), 8), "begin at offset 4");  // gap
  EXPECT_CONTAINS(refusal(two(1, 4, 4, 8), 8), "begin at offset 0");  // gap at the start
  EXPECT_CONTAINS(refusal(two(0, 4, 4, 9), 8), "8 data bytes");       // beyond the file
  EXPECT_CONTAINS(refusal(two(0, 4, 4, 8), 9), "8 bytes of tensor data");
  EXPECT_CONTAINS(refusal(R"({"a":{"dtype":"U8","shape":[0],"data_offsets":[8,4]}})", 8), "BEGIN <= END");
}

TEST_F(Safetensors, SizesThatDoNotFitTheShapeAreRefused) {
  const auto one = [](const std::string& shape, const std::string& offsets) {
    return R"({"a":{"dtype":"F32","shape":[)" + shape + R"(],"data_offsets":[)" + offsets + "]}}";
  };
  EXPECT_CONTAINS(refusal(one("2", "0,4"), 4), "8 bytes for F32 [2]");
  EXPECT_CONTAINS(refusal(one("", "0,8"), 8), "4 bytes for F32 []");
  EXPECT_CONTAINS(refusal(one("4611686018427387904,4", "0,0")), "2^63");
  EXPECT_CONTAINS(refusal(one("4294967296,4294967296", "0,0")), "2^63");
  EXPECT_CONTAINS(refusal(one("9223372036854775808", "0,0")), "2^63");
  EXPECT_CONTAINS(refusal(one("18446744073709551616", "0,0")), "1844674407370955");
  EXPECT_CONTAINS(refusal(one("1", "18446744073709551612,18446744073709551615"), 4), "span 3");
  EXPECT_CONTAINS(refusal(one("1", "18446744073709551608,18446744073709551612"), 4), "within");
}

TEST_F(Safetensors, EveryTruncationIsRefused) {
  const std::string four = "wxyz", two = "01";
  StateDict state;
  state.tensors["a"] = tensor(DataType::f32, {1}, four);
  state.tensors["b"] = tensor(DataType::f16, {1, 1}, two);
  write_safetensors(folder_ / "whole", state);
  const std::string whole = test::read_file(folder_ / "whole");
  for (std::size_t length = 0; length < whole.size(); ++length) {
    write_file(folder_ / "file", whole.substr(0, length));
    EXPECT_THROW(read_safetensors(folder_ / "file"), InputError) << length;
  }
}

TEST_F(Safetensors, WhatCannotBeWrittenLeavesNothingBehind) {
  const std::string four = "wxyz";
  StateDict state;
  state.tensors["a"] = tensor(DataType::f32, {2}, four);
  EXPECT_THROW(write_safetensors(folder_ / "out", state), InputError);
  state.tensors["a"].shape = {1};
  EXPECT_CONTAINS(message_of<Error>([&] { write_safetensors(folder_ / "none/out", state); }), "No such file");
  std::filesystem::create_directory(folder_ / "taken");
  EXPECT_THROW(write_safetensors(folder_ / "taken", state), Error);
  state.metadata["key"] = "\xFF";
  EXPECT_THROW(write_safetensors(folder_ / "out", state), InputError);
  state.metadata.clear();
  state.tensors["__metadata__"] = state.tensors["a"];
  EXPECT_THROW(write_safetensors(folder_ / "out", state), InputError);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);  // "taken"
}

}  // namespace
}  // namespace penumbra::nn
