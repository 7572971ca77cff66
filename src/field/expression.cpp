#include "pdx/field/expression.hpp"

#include "pdx/base/error.hpp"

#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <string>

namespace pdx::field {
/// Recursive descent: a rule of the grammar a function.
class ExpressionParser {
public:
  ExpressionParser(std::string_view text, Expression& into) : text_(text), into_(into) {}

  void whole()
  {
    sum();
    if (!at_end()) fail(text_[at_] == ')' ? "a bracket is closed that is not open" : "an operator is missing");
  }

private:
  using Act = Expression::Act;
  using Function = Expression::Function;
  static constexpr int kDeepest = 100; // brackets in brackets

  void sum()
  {
    product();
    for (;;)
      if (takes('+'))
        product(), put(Act::add);
      else if (takes('-'))
        product(), put(Act::subtract);
      else
        return;
  }
  void product()
  {
    signed_power();
    for (;;)
      if (takes('*'))
        signed_power(), put(Act::multiply);
      else if (takes('/'))
        signed_power(), put(Act::divide);
      else
        return;
  }
  void signed_power()
  {
    if (++depth_ > kDeepest) fail("there are too many brackets or signs in each other");
    if (takes('-'))
      signed_power(), put(Act::negate);
    else if (takes('+'))
      signed_power();
    else
      power();
    --depth_;
  }
  void power()
  {
    item();
    if (takes('^')) signed_power(), put(Act::power);
  }
  void item()
  {
    if (at_end()) fail("something is missing at the end");
    const char c = text_[at_];
    if (takes('(')) {
      sum();
      require(')', "a bracket is not closed");
    } else if (std::isdigit(static_cast<unsigned char>(c)) || c == '.')
      number();
    else if (std::isalpha(static_cast<unsigned char>(c)))
      name();
    else
      fail("a number, t or a function is missing");
  }
  void number()
  {
    double value = 0.0;
    const auto [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc()) fail("this is no number");
    at_ = static_cast<std::size_t>(end - text_.data());
    put(Act::number, value);
  }
  void name()
  {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) || text_[at_] == '_')) ++at_;
    const std::string_view word = text_.substr(begin, at_ - begin);
    if (word == "t") return put(Act::time);
    if (word == "pi") return put(Act::number, std::numbers::pi);
    static constexpr std::array<std::pair<std::string_view, Function>, 13> known{{{"sin", Function::sin},
                                                                                  {"cos", Function::cos},
                                                                                  {"tan", Function::tan},
                                                                                  {"tanh", Function::tanh},
                                                                                  {"exp", Function::exp},
                                                                                  {"log", Function::log},
                                                                                  {"sqrt", Function::sqrt},
                                                                                  {"abs", Function::abs},
                                                                                  {"sign", Function::sign},
                                                                                  {"step", Function::step},
                                                                                  {"heaviside", Function::step},
                                                                                  {"min", Function::min},
                                                                                  {"max", Function::max}}};
    for (const auto& [called, function] : known)
      if (word == called) return call(called, function);
    at_ = begin;
    fail(fmt::format("\"{}\" is unknown, there are t, pi, {}", word, Expression::kFunctions));
  }
  void call(std::string_view called, Function function)
  {
    require('(', fmt::format("{} is a function: a bracket is missing", called));
    sum();
    if (function == Function::min || function == Function::max) {
      require(',', fmt::format("{} has two values, with a comma between", called));
      sum();
    }
    require(')', text_.substr(std::min(at_, text_.size())).starts_with(',') ? "this function has fewer values"
                                                                            : "a bracket is not closed");
    into_.program_.push_back({Act::call, 0.0, function});
  }

  void put(Act act, double number = 0.0) { into_.program_.push_back({act, number, Function::sin}); }
  bool at_end()
  {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    return at_ == text_.size();
  }
  bool takes(char c)
  {
    if (at_end() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  void require(char c, const std::string& otherwise)
  {
    if (!takes(c)) fail(otherwise);
  }
  [[noreturn]] void fail(const std::string& what) const
  {
    throw UserError(fmt::format("at character {}{}: {}", at_ + 1,
                                at_ < text_.size() ? fmt::format(" (\"{}\")", text_.substr(at_, 12)) : ", its end",
                                what));
  }

  std::string_view text_;
  Expression& into_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

Expression::Expression(std::string_view text) { ExpressionParser(text, *this).whole(); }

Expression::Value Expression::of_one(Function function, const Value& x)
{
  const double v = x.value, d = x.rate, sign = v > 0.0 ? 1.0 : v < 0.0 ? -1.0 : 0.0;
  switch (function) {
  case Function::sin:
    return {std::sin(v), std::cos(v) * d};
  case Function::cos:
    return {std::cos(v), -std::sin(v) * d};
  case Function::tan:
    return {std::tan(v), d / (std::cos(v) * std::cos(v))};
  case Function::tanh:
    return {std::tanh(v), d / (std::cosh(v) * std::cosh(v))};
  case Function::exp:
    return {std::exp(v), std::exp(v) * d};
  case Function::log:
    return {std::log(v), d / v};
  case Function::sqrt:
    return {std::sqrt(v), d == 0.0 ? 0.0 : 0.5 * d / std::sqrt(v)};
  case Function::abs:
    return {std::abs(v), sign * d};
  case Function::sign:
    return {sign, 0.0};
  default:
    return {v >= 0.0 ? 1.0 : 0.0, 0.0};
  }
}

Expression::Value Expression::of_two(Function function, const Value& x, const Value& y)
{
  return (function == Function::min) == (x.value <= y.value) ? x : y;
}

Expression::Value Expression::at(double time) const
{
  const auto power = [](const Value& x, const Value& y) -> Value {
    const double v = std::pow(x.value, y.value);
    double rate = x.rate == 0.0 ? 0.0 : y.value * std::pow(x.value, y.value - 1.0) * x.rate;
    if (y.rate != 0.0) rate += v * std::log(x.value) * y.rate;
    return {v, rate};
  };
  stack_.clear();
  const auto pop = [this] {
    const Value top = stack_.back();
    stack_.pop_back();
    return top;
  };
  for (const Instruction& now : program_) {
    if (now.act == Act::number || now.act == Act::time) {
      stack_.push_back(now.act == Act::time ? Value{time, 1.0} : Value{now.number, 0.0});
      continue;
    }
    const Value y = pop();
    const bool one = now.act == Act::negate ||
                     (now.act == Act::call && now.function != Function::min && now.function != Function::max);
    const Value x = one ? y : pop();
    switch (now.act) {
    case Act::add:
      stack_.push_back({x.value + y.value, x.rate + y.rate});
      break;
    case Act::subtract:
      stack_.push_back({x.value - y.value, x.rate - y.rate});
      break;
    case Act::multiply:
      stack_.push_back({x.value * y.value, x.rate * y.value + x.value * y.rate});
      break;
    case Act::divide:
      stack_.push_back({x.value / y.value, (x.rate - x.value / y.value * y.rate) / y.value});
      break;
    case Act::power:
      stack_.push_back(power(x, y));
      break;
    case Act::negate:
      stack_.push_back({-y.value, -y.rate});
      break;
    default:
      stack_.push_back(one ? of_one(now.function, y) : of_two(now.function, x, y));
    }
  }
  return stack_.back();
}
} // namespace pdx::field
