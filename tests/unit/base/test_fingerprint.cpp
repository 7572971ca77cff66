#include "pdx/base/fingerprint.hpp"

#include <array>
#include <gtest/gtest.h>

using namespace pdx;

// XXH3's own test values: of no bytes without a seed; whatever the processor, or files would not be known elsewhere.
TEST(Fingerprint, IsXXH3)
{
  EXPECT_EQ(hash_of({}), 0x2d06800538d394c2U);
  EXPECT_EQ(hash_of({}), Fingerprint().add(std::span<const double>()).value());
}

TEST(Fingerprint, TellsOrderAndEveryBitApart)
{
  const std::array<int, 3> some{1, 2, 3}, other{1, 3, 2};
  const auto of = [](const auto& a) { return Fingerprint().add(std::span<const int>(a)).value(); };
  EXPECT_EQ(of(some), of(std::array<int, 3>{1, 2, 3}));
  EXPECT_NE(of(some), of(other));
  for (int bit = 0; bit < 96; ++bit) {
    std::array<int, 3> flipped = some;
    flipped[static_cast<std::size_t>(bit / 32)] ^= static_cast<int>(1U << (bit % 32));
    EXPECT_NE(of(some), of(flipped)) << bit;
  }
}

TEST(Fingerprint, GoesOnFromWhatWasBefore)
{
  const std::array<double, 2> a{0.5, 1.0}, b{2.0, 4.0};
  const auto in_order = Fingerprint().add(std::span<const double>(a)).add(std::span<const double>(b)).value();
  EXPECT_EQ(in_order, hash_of(std::as_bytes(std::span(b)), hash_of(std::as_bytes(std::span(a)))));
  EXPECT_NE(in_order, Fingerprint().add(std::span<const double>(b)).add(std::span<const double>(a)).value());
}
