#include "pdx/field/expression.hpp"

#include "pdx/base/error.hpp"
#include "pdx/field/history.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <string>

namespace {
using pdx::field::Expression;
using pdx::field::History;

double value(const char* text, double t = 0.0) { return Expression(text).at(t).value; }

std::string refusal(const std::string& text)
{
  try {
    (void)Expression(text);
  } catch (const pdx::UserError& error) {
    return error.what();
  }
  return "";
}

TEST(Expression, BindsAsOnPaper)
{
  EXPECT_EQ(value("1 + 2*3"), 7.0);
  EXPECT_EQ(value("(1 + 2)*3"), 9.0);
  EXPECT_EQ(value("8 - 2 - 1"), 5.0);
  EXPECT_EQ(value("8/2/2"), 2.0);
  EXPECT_EQ(value("2^3^2"), 512.0);
  EXPECT_EQ(value("-2^2"), -4.0);
  EXPECT_EQ(value("2^-1"), 0.5);
  EXPECT_EQ(value("-+-3"), 3.0);
  EXPECT_EQ(value("1.5e-3*t", 2.0), 3e-3);
}

TEST(Expression, KnowsItsFunctions)
{
  EXPECT_DOUBLE_EQ(value("sin(pi/6)"), 0.5);
  EXPECT_DOUBLE_EQ(value("cos(pi/3) + exp(0) + sqrt(16)"), 5.5);
  EXPECT_DOUBLE_EQ(value("tan(pi/4) + log(exp(2)) + tanh(0)"), 3.0);
  EXPECT_EQ(value("min(t, 3) + max(t, 3)", 2.0), 5.0);
  EXPECT_EQ(value("abs(-t) + sign(-t)", 2.0), 1.0);
  EXPECT_EQ(value("step(t - 1)", 0.999), 0.0);
  EXPECT_EQ(value("heaviside(t - 1)", 1.0), 1.0);
}

TEST(Expression, ItsRateIsTheDerivative)
{
  for (const char* text :
       {"sin(2*pi*t)*exp(-t)", "t^3/(1 + t)", "sqrt(t)*cos(t^2)", "2^t", "t^t", "min(t^2, 5)*max(0.1, t)", "abs(t - 9)",
        "tanh(t)*tan(t/4)", "log(1 + t)", "step(t)*t", "-t/(2 - t)"}) {
    const Expression f(text);
    const double t = 0.7, h = 1e-6, slope = (f.at(t + h).value - f.at(t - h).value) / (2.0 * h);
    EXPECT_NEAR(f.at(t).rate, slope, 1e-8 * (1.0 + std::abs(slope))) << text;
  }
}

TEST(Expression, TellsWhatIsWrongAndWhere)
{
  EXPECT_EQ(refusal("sin(2*t"), "at character 8, its end: a bracket is not closed");
  EXPECT_TRUE(refusal("2*").starts_with("at character 3, its end: something is missing"));
  EXPECT_TRUE(refusal("2 t").starts_with("at character 3 (\"t\"): an operator is missing"));
  EXPECT_TRUE(refusal("1 + sine(t)").starts_with("at character 5 (\"sine(t)\"): \"sine\" is unknown"));
  EXPECT_TRUE(refusal("t)").starts_with("at character 2 (\")\"): a bracket is closed that is not open"));
  EXPECT_TRUE(refusal("min(t)").starts_with("at character 6 (\")\"): min has two values"));
  EXPECT_TRUE(refusal("sin(t, 1)").starts_with("at character 6 (\", 1)\"): this function has fewer values"));
  EXPECT_TRUE(refusal("sin t").find("sin is a function") != std::string::npos);
  EXPECT_TRUE(refusal("").find("something is missing") != std::string::npos);
  EXPECT_TRUE(refusal(std::string(5000, '(')).find("too many brackets") != std::string::npos);
}

TEST(History, AFormulaIsSummedUpFromZero)
{
  const History h = History::expression("sin(2*pi*t)*step(t - 0.25)", 0.1);
  const auto exact = [](double t) {
    return t < 0.25 ? 0.0 : -std::cos(2.0 * std::numbers::pi * t) / (2.0 * std::numbers::pi);
  };
  for (const double t : {0.0, 0.2, 0.3, 0.95, 3.17}) EXPECT_NEAR(h.integral(t), exact(t), 1e-9) << t;
  const double later = h.integral(2.0);
  EXPECT_EQ(History::expression("sin(2*pi*t)*step(t - 0.25)", 0.1).integral(2.0), later); // whatever was asked before
  EXPECT_DOUBLE_EQ(h.value(0.5), std::sin(std::numbers::pi));
}
} // namespace
