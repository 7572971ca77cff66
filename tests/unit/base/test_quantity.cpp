#include "pdx/base/error.hpp"
#include "pdx/base/quantity.hpp"

#include <cmath>
#include <gtest/gtest.h>

using namespace pdx;

TEST(Quantity, IsTheNumberInTheUnitOfSi)
{
  EXPECT_EQ(value_in("72GPa", "Pa"), 72e9);
  EXPECT_EQ(value_in("1mm", "m"), 1e-3);
  EXPECT_EQ(value_in("72.5mm", "m"), 0.0725);
  EXPECT_EQ(value_in("-3nm", "m"), -3e-9);
  EXPECT_EQ(value_in("20us", "s"), 20e-6);
  EXPECT_EQ(value_in("20\xC2\xB5s", "s"), 20e-6);
  EXPECT_EQ(value_in("2.44g/cm^3", "kg/m^3"), 2440.0);
  EXPECT_EQ(value_in("3.8J/m2", "J/m^2"), 3.8);
  EXPECT_EQ(value_in("1N/mm", "J/m^2"), 1000.0);
  EXPECT_EQ(value_in("1N/mm^2", "Pa"), 1e6);
  EXPECT_EQ(value_in("1mm/us", "m/s"), 1000.0);
  EXPECT_EQ(value_in("2h", "s"), 7200.0);
  EXPECT_EQ(value_in("5%", "-"), 0.05);
  EXPECT_EQ(value_in("1e3kg*m^-3", "kg/m^3"), 1000.0);
  EXPECT_EQ(value_in("4Hz", "1/s"), 4.0);
}

TEST(Quantity, MayBeAQuotientOfTwoNumbers)
{
  EXPECT_EQ(value_in("1/3", "-"), 1.0 / 3.0);
  EXPECT_EQ(value_in("-3/4", ""), -0.75);
  EXPECT_EQ(value_in("1/4mm", "m"), 0.25e-3);
  EXPECT_EQ(value_in("3/m", "1/m"), 3.0);
  for (const char* word : {"1/0", "0/0", "1//3", "1/-3", "1/3/2", "1/x"}) EXPECT_FALSE(value_in(word, "-")) << word;
}

TEST(Quantity, WithoutAUnitIsAsItStands)
{
  EXPECT_EQ(value_in("0.1", "m"), 0.1);
  EXPECT_EQ(value_in("+1e9", "Pa"), 1e9);
  EXPECT_TRUE(std::isinf(*value_in("inf", "m")));
}

TEST(Quantity, OfAnotherKindIsRefused)
{
  for (const char* word : {"72mm", "1s", "1N", "1J/m", "5%", "1kg/m^3"})
    EXPECT_THROW((void)value_in(word, "Pa"), UserError) << word;
  EXPECT_THROW((void)value_in("1mm", "-"), UserError);
  EXPECT_THROW((void)value_in("1m", ""), UserError);
}

TEST(Quantity, WhatIsNoUnitIsNoNumber)
{
  for (const char* word :
       {"1Mm2x", "1gpa", "1mmm", "1m/", "1/", "1 mm", "1kmin", "1^2", "1m^", "m", "", "1m^99", "1d5"})
    EXPECT_FALSE(value_in(word, "m")) << word;
}
