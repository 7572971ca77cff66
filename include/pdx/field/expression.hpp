#pragma once
#include <string_view>
#include <vector>

namespace pdx::field {
/// A formula of the time t, e.g. "sin(2*pi*t/1e-3)*min(t/1e-6, 1)": numbers, t and pi, + - * / ^ and brackets,
/// `kFunctions`. ^ goes from right to left and before a sign in front of it: -2^2 is -4. Pure.
class Expression {
public:
  static constexpr const char* kFunctions =
      "sin, cos, tan, tanh, exp, log, sqrt, abs, sign, step (heaviside), min, max";

  /// Throws UserError that tells what is wrong at which character, from 1.
  explicit Expression(std::string_view text);

  /// A value and how fast it changes: at a kink or a jump as on either side of it, a jump being no change.
  struct Value {
    double value = 0.0, rate = 0.0; ///< [-], [1/s]
  };
  Value at(double time) const;

private:
  friend class ExpressionParser;
  enum class Act { number, time, add, subtract, multiply, divide, power, negate, call };
  enum class Function { sin, cos, tan, tanh, exp, log, sqrt, abs, sign, step, min, max };
  struct Instruction {
    Act act = Act::number;
    double number = 0.0;
    Function function = Function::sin;
  };
  static Value of_one(Function function, const Value& x);
  static Value of_two(Function function, const Value& x, const Value& y);

  std::vector<Instruction> program_; // values first, then what is done with them
  mutable std::vector<Value> stack_;
};
} // namespace pdx::field
