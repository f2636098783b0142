#include "nn/base/text.h"

#include <gtest/gtest.h>

namespace penumbra {
namespace {

TEST(Text, WellFormedUtf8IsRecognised) {
  EXPECT_TRUE(is_utf8(""));
  EXPECT_TRUE(is_utf8("conv1.weight \xC3\xA4 \xE6\xA8\xA1 \xF0\x9F\x98\x80"));
  EXPECT_FALSE(is_utf8("\x80"));
  EXPECT_FALSE(is_utf8("\xC3"));              // cut
  EXPECT_FALSE(is_utf8("\xC0\xAF"));          // overlong
  EXPECT_FALSE(is_utf8("\xE0\x80\xAF"));      // overlong
  EXPECT_FALSE(is_utf8("\xED\xA0\x80"));      // surrogate
  EXPECT_FALSE(is_utf8("\xF4\x90\x80\x80"));  // above U+10FFFF
}

TEST(Text, MarkupHoldsAnyText) {
  EXPECT_EQ(as_markup("a < b && \"c\" > 'd'\n\t"), "a &lt; b &amp;&amp; &quot;c&quot; &gt; 'd'\n\t");
  EXPECT_EQ(as_markup("\xC3\xA4\x1b["), "\xC3\xA4 [");
  EXPECT_EQ(as_markup("\xC3\xA4\xFF<"), "???&lt;");
}

TEST(Text, WhatCouldHarmATerminalIsEscaped) {
  EXPECT_EQ(printable("a\x1b[31mb\n"), "a\\x1b[31mb\\x0a");
  EXPECT_EQ(printable("\xC3\xA4\xFF"), "\xC3\xA4\\xff");
  EXPECT_EQ(printable("\xC2\x9B"), "\\xc2\\x9b");  // U+009B, CSI
  EXPECT_EQ(printable("abcdef", 3), "abc...");
}

}  // namespace
}  // namespace penumbra
