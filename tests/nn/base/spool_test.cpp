#include "nn/base/spool.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <random>

#include "tests/support/test_data.h"

namespace penumbra {
namespace {

struct Row {
  std::uint64_t number = 0;
  double value = 0.0;
  int more[3] = {};
};

Row row(std::uint64_t i) {
  const int n = static_cast<int>(i);
  return {i, 0.5 * static_cast<double>(i), {n, -n, 2 * n}};
}

void expect_rows(const Spool<Row>& rows, std::uint64_t count) {
  ASSERT_EQ(rows.size(), count);
  std::uint64_t i = 0;
  for (const Row& r : rows) {
    ASSERT_EQ(r.number, i);
    ASSERT_EQ(r.value, row(i).value);
    ASSERT_EQ(r.more[2], row(i).more[2]);
    ++i;
  }
  EXPECT_EQ(i, count);
  std::mt19937_64 random(5);
  for (int k = 0; count > 0 && k < 200; ++k) {
    const std::uint64_t at = random() % count;
    ASSERT_EQ(rows[at].number, at);
  }
}

TEST(Spool, GivesBackWhatItTook) {
  const test::TemporaryDirectory folder;
  Spool<Row> rows(folder.path());
  EXPECT_TRUE(rows.empty());
  std::uint64_t count = 0;
  for (const std::uint64_t size : {0, 1, 100, 1638, 1639, 5000, 20001}) {
    while (count < size) rows.push_back(row(count++));
    expect_rows(rows, count);
    if (count > 0) {
      EXPECT_EQ(rows.back().number, count - 1);
    }
  }
}

TEST(Spool, KeepsTheNewestAloneInMemoryAndLeavesNoFile) {
  const test::TemporaryDirectory folder;
  {
    Spool<Row> rows(folder.path());
    for (std::uint64_t i = 0; i < 50000; ++i) rows.push_back(row(i));
    EXPECT_GE(rows.bytes_on_disk() + SpoolFile::kBlock, rows.size() * sizeof(Row));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Spool, HoldsAllWhereNoFileCanBe) {
  Spool<Row> rows("/there/is/no/such/folder");
  for (std::uint64_t i = 0; i < 10000; ++i) rows.push_back(row(i));
  EXPECT_EQ(rows.bytes_on_disk(), 0U);
  expect_rows(rows, 10000);
}

// Also while the first one goes on and when it is gone; neither sees the other's rows.
TEST(Spool, ACopyHoldsWhatThereWas) {
  const test::TemporaryDirectory folder;
  for (const std::uint64_t size : {0, 7, 1639, 9001}) {
    auto rows = std::make_unique<Spool<Row>>(folder.path());
    for (std::uint64_t i = 0; i < size; ++i) rows->push_back(row(i));
    Spool<Row> copy(*rows);
    for (std::uint64_t i = size; i < size + 8000; ++i) rows->push_back(row(i));
    expect_rows(copy, size);
    for (std::uint64_t i = size; i < size + 3000; ++i) copy.push_back(row(i));
    expect_rows(*rows, size + 8000);
    rows.reset();
    expect_rows(copy, size + 3000);
  }
}

TEST(Spool, MayBeReadAtSeveralPlacesAtOnceAndGrowMeanwhile) {
  const test::TemporaryDirectory folder;
  Spool<Row> rows(folder.path());
  for (std::uint64_t i = 0; i < 9000; ++i) rows.push_back(row(i));
  auto first = rows.begin(), second = rows.begin();
  for (int k = 0; k < 5000; ++k) ++second;
  for (std::uint64_t i = 0; i < 4000; ++i, ++first, ++second) {
    ASSERT_EQ(first->number, i);
    ASSERT_EQ(second->number, 5000 + i);
    if (i % 10 == 0) rows.push_back(row(rows.size()));
  }
  expect_rows(rows, 9400);
}

}  // namespace
}  // namespace penumbra
