#include "pdx/io/seal.hpp"

#include <gtest/gtest.h>

using namespace pdx;
using io::Seal, io::SealHead;

namespace {
/// A file of one table of two rows and a few bytes of its own behind.
Seal some()
{
  const std::vector<std::byte> bytes(60, std::byte{7});
  Seal seal;
  seal.tables = {{"/displacement", "f64", 2, 3, Seal::kHeadBytes}, {"/use", "u8", 0, 1, 0}};
  seal.cover(Seal::kHeadBytes, std::span(bytes).first(48));
  seal.cover(Seal::kHeadBytes + 48, std::span(bytes).last(12));
  return seal;
}
constexpr std::uint64_t kEnd = Seal::kHeadBytes + 60;
} // namespace

TEST(Seal, ComesBackFromItsText)
{
  const auto read = Seal::from(some().text(), kEnd);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->text(), some().text());
  EXPECT_EQ(read->name_at(Seal::kHeadBytes + 47), "/displacement");
  EXPECT_EQ(read->name_at(Seal::kHeadBytes + 48), "");
}

TEST(Seal, IsNoneWhereTheFileIsNotFilledByIt)
{
  EXPECT_FALSE(Seal::from(some().text(), kEnd + 1));
  EXPECT_FALSE(Seal::from(some().text(), kEnd - 1));
  EXPECT_FALSE(Seal::from("", kEnd));
  EXPECT_FALSE(Seal::from("{}", kEnd));
  for (const auto& spoil : {+[](Seal& s) { s.tables[0].rows = 3; },  // beyond the end
                            +[](Seal& s) { s.tables[0].rows = -1; }, //
                            +[](Seal& s) { s.tables[0].at = 8; },    // in the head
                            +[](Seal& s) { s.extents.pop_back(); },  // a hole
                            +[](Seal& s) { std::swap(s.extents[0], s.extents[1]); }}) {
    Seal wrong = some();
    spoil(wrong);
    EXPECT_FALSE(Seal::from(wrong.text(), kEnd));
  }
}

TEST(Seal, CoversLargeTablesByParts)
{
  const std::vector<std::byte> bytes(Seal::kMostBytes + 5);
  Seal seal;
  seal.cover(Seal::kHeadBytes, bytes);
  ASSERT_EQ(seal.extents.size(), 2u);
  EXPECT_EQ(seal.extents[1].at, Seal::kHeadBytes + Seal::kMostBytes);
  EXPECT_EQ(seal.extents[1].bytes, 5u);
}

TEST(SealHead, ComesBackAndIsAnotherWithAnyByteChanged)
{
  const SealHead head{Seal::kFormat, 1234567, 89, 0xfedcba9876543210U};
  const std::string text = head.text();
  ASSERT_EQ(text.size(), Seal::kHeadBytes);
  ASSERT_TRUE(SealHead::from(text));
  EXPECT_EQ(*SealHead::from(text), head);
  EXPECT_EQ(SealHead::from(text)->text(), text);
  for (std::size_t k = 0; k < text.size(); ++k) {
    std::string spoilt = text;
    spoilt[k] = static_cast<char>(spoilt[k] ^ 1);
    const auto read = SealHead::from(spoilt);
    EXPECT_TRUE(!read || read->text() != spoilt) << k; // what is read is not what stands there: refused
  }
  EXPECT_FALSE(SealHead::from("\x89HDF"));
  EXPECT_EQ(SealHead::from("pdxsolve sealed file, format 3\n")->format, 3);
}
