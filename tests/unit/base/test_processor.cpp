#include "pdx/base/error.hpp"
#include "pdx/base/processor.hpp"

#include <cstdlib>
#include <gtest/gtest.h>

namespace {
using namespace pdx;

/// Sets PDX_SIMD for as long as this object lives.
struct Wish {
  explicit Wish(const char* name) { setenv("PDX_SIMD", name, 1); }
  ~Wish() { unsetenv("PDX_SIMD"); }
  Wish(const Wish&) = delete;
  Wish& operator=(const Wish&) = delete;
};

TEST(Processor, TheEnvironmentChooses)
{
  EXPECT_EQ(chosen_processor(), this_processor());
  const Wish wish("portable");
  EXPECT_EQ(chosen_processor(), Processor::any);
  EXPECT_EQ(lanes_of(Processor::any), 2);
  EXPECT_EQ(lanes_of(Processor::avx512), 8);
}

TEST(Processor, RefusesWhatItDoesNotKnowOrHave)
{
  const Wish wish("neon");
  EXPECT_THROW(chosen_processor(), UserError);
  if (this_processor() == Processor::avx512) return;
  const Wish wide("avx512");
  EXPECT_THROW(chosen_processor(), UserError);
}
} // namespace
