#pragma once
#include "pdx/base/petsc.hpp"

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace pdx {
/// Allowed values of a number; ends included unless `open_lower`.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool open_lower = false;
  static Range positive() { return {0.0, std::numeric_limits<double>::infinity(), true}; }
  static Range at_least(double lower) { return {lower}; }
};

/// What `-help` shows of one option.
struct OptionDoc {
  std::string room, name, unit, default_value, allowed, help;
};

/// Reads our options from `given_options`: name, help, unit, default and allowed values meet in one call. A value that
/// does not parse or is out of range throws UserError. Every name read is remembered for `-help` and for the refusal of
/// unknown names.
class Options {
public:
  explicit Options(std::string room) : room_(std::move(room)) {}

  bool given(const std::string& name) const;
  double real(const std::string& name, double value, const char* unit, const char* help, Range range = {});
  int integer(const std::string& name, int value, const char* help, Range range = {});
  bool boolean(const std::string& name, bool value, const char* help);
  std::string text(const std::string& name, const std::string& value, const char* help);
  /// One of `allowed`; returns its position in the list.
  int choice(const std::string& name, int value, std::span<const char* const> allowed, const char* help);
  /// Comma-separated numbers; `count` = 0 takes any number of them.
  std::vector<double> reals(const std::string& name, std::vector<double> value, std::size_t count, const char* unit,
                            const char* help, Range range = {});
  std::vector<int> integers(const std::string& name, std::vector<int> value, std::size_t count, const char* help,
                            Range range = {});
  std::vector<std::string> texts(const std::string& name, std::vector<std::string> value, const char* help);

private:
  std::optional<std::string> find(const std::string& name) const;
  void document(const std::string& name, const char* unit, std::string default_value, std::string allowed,
                const char* help);
  std::string room_;
};

/// One number of an option, with or without a unit behind it, in the SI unit `unit`; none: it is no number. Throws
/// UserError for a unit of another kind.
std::optional<double> number_of(const std::string& name, const std::string& text, const char* unit);
/// Throws UserError for a list of which some numbers have units and others, not 0, have none: 1,2mm.
void require_units_alike(const std::string& name, std::span<const std::string> items);

/// Every option read so far, in order of reading.
const std::vector<OptionDoc>& documented_options();
bool is_documented(std::string_view name);
/// Another scene is read: its options are those read from here on.
void forget_documented_options();
/// Letters to change, add or leave out from one to the other.
std::size_t edit_distance(std::string_view a, std::string_view b);
/// The documented name nearest to `name` by edit distance ("" if none is near).
std::string nearest_option(std::string_view name);
/// Throws UserError for the first given option that neither we nor PETSc know. PETSc's own (-snes_..., -ksp_...,
/// -log_view) pass. Call after all our options were read.
void refuse_unknown_options();
} // namespace pdx
