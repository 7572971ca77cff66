#include "pdx/base/error.hpp"
#include "pdx/pd/processor.hpp"

#include <cstdlib>
#include <gtest/gtest.h>

namespace {
using namespace pdx;
using pd::Processor;

/// Sets PDX_SIMD for as long as this object lives.
struct Wish {
  explicit Wish(const char* name) { setenv("PDX_SIMD", name, 1); }
  ~Wish() { unsetenv("PDX_SIMD"); }
  Wish(const Wish&) = delete;
  Wish& operator=(const Wish&) = delete;
};

TEST(Processor, TheEnvironmentChooses)
{
  EXPECT_EQ(pd::chosen_processor(), pd::this_processor());
  const Wish wish("portable");
  EXPECT_EQ(pd::chosen_processor(), Processor::any);
  EXPECT_EQ(pd::lanes_of(Processor::any), 2);
  EXPECT_EQ(pd::lanes_of(Processor::avx512), 8);
}

TEST(Processor, RefusesWhatItDoesNotKnowOrHave)
{
  const Wish wish("neon");
  EXPECT_THROW(pd::chosen_processor(), UserError);
  if (pd::this_processor() == Processor::avx512) return;
  const Wish wide("avx512");
  EXPECT_THROW(pd::chosen_processor(), UserError);
}
} // namespace
