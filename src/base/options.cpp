#include "pdx/base/options.hpp"

#include "pdx/base/given_options.hpp"
#include "pdx/base/number.hpp"
#include "pdx/base/petsc_names.hpp"
#include "pdx/base/quantity.hpp"
#include "pdx/base/shown.hpp"
#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <limits>

namespace pdx {
namespace {
std::vector<OptionDoc>& documents()
{
  static std::vector<OptionDoc> all;
  return all;
}

std::vector<std::string> split(const std::string& text)
{
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end = text.find(','); end != std::string::npos; end = text.find(',', begin)) {
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  parts.push_back(text.substr(begin));
  for (std::string& part : parts) {
    part.erase(0, part.find_first_not_of(" \t"));
    part.erase(part.find_last_not_of(" \t") + 1);
  }
  return parts;
}

/// The value, or what `read` makes of it; refuses none.
template <class Read> auto parse(const std::string& name, const std::string& text, const char* what, Read&& read)
{
  if (text.empty()) throw UserError(fmt::format("{} has no value where {} belongs", name, what));
  const auto value = read(text);
  if (!value) throw UserError(fmt::format("{} is \"{}\": must be {}", name, shown(text), what));
  return *value;
}

std::string describe(const Range& range)
{
  const bool low = std::isfinite(range.lower), high = std::isfinite(range.upper);
  if (low && high)
    return fmt::format("{} {} and at most {}", range.open_lower ? "above" : "at least", range.lower, range.upper);
  if (low) return fmt::format("{} {}", range.open_lower ? "above" : "at least", range.lower);
  if (high) return fmt::format("at most {}", range.upper);
  return "any number";
}

void require_range(const std::string& name, double value, const char* unit, const Range& range)
{
  const bool inside = (range.open_lower ? value > range.lower : value >= range.lower) && value <= range.upper;
  if (!std::isfinite(value)) throw UserError(fmt::format("{} is {}: must be a finite number", name, value));
  if (!inside)
    throw UserError(fmt::format("{} is {}: must be {}{}{}", name, value, describe(range), *unit ? " " : "", unit));
}

double parse_real(const std::string& name, const std::string& text, const char* unit, const Range& range)
{
  const char* what = *unit && *unit != '-' ? "a number, its unit if any directly behind it" : "a number";
  const double value = parse(name, text, what, [&](const std::string& word) { return number_of(name, word, unit); });
  require_range(name, value, unit, range);
  return value;
}

int parse_integer(const std::string& name, const std::string& text, const Range& range)
{
  const auto value = static_cast<double>(parse(name, text, "a whole number", whole_in));
  constexpr double least = std::numeric_limits<int>::min(), most = std::numeric_limits<int>::max();
  require_range(name, value, "", {std::max(range.lower, least), std::min(range.upper, most), range.open_lower});
  return static_cast<int>(value);
}

/// The items of a list, as many as are wanted (0: any number).
std::vector<std::string> items_of(const std::string& name, const std::string& text, std::size_t wanted)
{
  if (text.empty()) throw UserError(fmt::format("{} has no value where numbers belong", name));
  std::vector<std::string> items = split(text);
  if (wanted && items.size() != wanted)
    throw UserError(fmt::format("{} has {} values: must have {}, separated by commas", name, items.size(), wanted));
  for (const std::string& item : items)
    if (item.empty())
      throw UserError(fmt::format("{} is \"{}\": an item is empty; separate items by one comma", name, shown(text)));
  return items;
}
} // namespace

std::size_t edit_distance(std::string_view a, std::string_view b)
{
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t change = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, change});
    }
  }
  return row[b.size()];
}

std::optional<double> number_of(const std::string& name, const std::string& text, const char* unit)
{
  try {
    return value_in(text, unit);
  } catch (const UserError& wrong) {
    throw UserError(fmt::format("{} is \"{}\": {}", name, shown(text), wrong.what()));
  }
}

void require_units_alike(const std::string& name, std::span<const std::string> items)
{
  const std::string *with = nullptr, *without = nullptr;
  for (const std::string& item : items)
    if (const auto quantity = quantity_in(item); quantity && quantity->number != 0.0)
      (quantity->unit.empty() ? without : with) = &item;
  if (with && without)
    throw UserError(fmt::format("{} has {} with a unit and {} without: write the unit behind each number, or none",
                                name, shown(*with), shown(*without)));
}

std::optional<std::string> Options::find(const std::string& name) const
{
  const GivenOption* option = given_option(name);
  return option ? std::optional(option->value) : std::nullopt;
}

void Options::document(const std::string& name, const char* unit, std::string default_value, std::string allowed,
                       const char* help)
{
  if (!is_documented(name))
    documents().push_back({room_, name, unit, std::move(default_value), std::move(allowed), help});
}

bool Options::given(const std::string& name) const { return find(name).has_value(); }

double Options::real(const std::string& name, double value, const char* unit, const char* help, Range range)
{
  document(name, unit, std::isnan(value) ? "none" : fmt::format("{}", value), describe(range), help);
  const auto text = find(name);
  return text ? parse_real(name, *text, unit, range) : value;
}

int Options::integer(const std::string& name, int value, const char* help, Range range)
{
  document(name, "", fmt::format("{}", value), describe(range), help);
  const auto text = find(name);
  return text ? parse_integer(name, *text, range) : value;
}

bool Options::boolean(const std::string& name, bool value, const char* help)
{
  document(name, "", value ? "true" : "false", "true, false", help);
  const auto text = find(name);
  if (!text) return value;
  for (const char* yes : {"", "true", "1", "yes", "on"})
    if (*text == yes) return true;
  for (const char* no : {"false", "0", "no", "off"})
    if (*text == no) return false;
  throw UserError(fmt::format("{} is \"{}\": must be true or false", name, shown(*text)));
}

std::string Options::text(const std::string& name, const std::string& value, const char* help)
{
  document(name, "", value.empty() ? "none" : value, "text", help);
  const auto text = find(name);
  if (text && text->empty()) throw UserError(fmt::format("{} has no value: give one", name));
  return text ? *text : value;
}

int Options::choice(const std::string& name, int value, std::span<const char* const> allowed, const char* help)
{
  const std::string list = fmt::format("{}", fmt::join(allowed, ", "));
  document(name, "", allowed[static_cast<std::size_t>(value)], list, help);
  const auto text = find(name);
  if (!text) return value;
  std::size_t best = 0, distance = std::string::npos;
  for (std::size_t k = 0; k < allowed.size(); ++k) {
    if (*text == allowed[k]) return static_cast<int>(k);
    const std::size_t d = edit_distance(*text, allowed[k]);
    if (d < distance) best = k, distance = d;
  }
  throw UserError(
      fmt::format("{} is \"{}\": must be one of {}; did you mean {}?", name, shown(*text), list, allowed[best]));
}

std::vector<double> Options::reals(const std::string& name, std::vector<double> value, std::size_t count,
                                   const char* unit, const char* help, Range range)
{
  document(name, unit, value.empty() ? "none" : fmt::format("{}", fmt::join(value, ",")), describe(range), help);
  const auto text = find(name);
  if (!text) return value;
  value.clear();
  const std::vector<std::string> items = items_of(name, *text, count);
  for (const std::string& part : items) value.push_back(parse_real(name, part, unit, range));
  require_units_alike(name, items);
  return value;
}

std::vector<int> Options::integers(const std::string& name, std::vector<int> value, std::size_t count, const char* help,
                                   Range range)
{
  document(name, "", value.empty() ? "none" : fmt::format("{}", fmt::join(value, ",")), describe(range), help);
  const auto text = find(name);
  if (!text) return value;
  value.clear();
  for (const std::string& part : items_of(name, *text, count)) value.push_back(parse_integer(name, part, range));
  return value;
}

std::vector<std::string> Options::texts(const std::string& name, std::vector<std::string> value, const char* help)
{
  document(name, "", value.empty() ? "none" : fmt::format("{}", fmt::join(value, ",")), "texts", help);
  const auto text = find(name);
  if (!text) return value;
  value = split(*text);
  if (std::any_of(value.begin(), value.end(), [](const std::string& part) { return part.empty(); }))
    throw UserError(fmt::format("{} is \"{}\": an item is empty; separate items by one comma", name, shown(*text)));
  return value;
}

namespace {
/// A name of PETSc's families that is all but one of ours of the same family.
bool misspelt(std::string_view given)
{
  return std::ranges::any_of(documents(), [&](const OptionDoc& doc) {
    return doc.name.size() > 8 && doc.name.starts_with("-ts_") && edit_distance(given, doc.name) <= 2;
  });
}
} // namespace

const std::vector<OptionDoc>& documented_options() { return documents(); }

void forget_documented_options() { documents().clear(); }

bool is_documented(std::string_view name)
{
  return std::ranges::any_of(documents(), [&](const OptionDoc& doc) { return doc.name == name; });
}

std::string nearest_option(std::string_view name)
{
  std::string best;
  std::size_t distance = std::max<std::size_t>(3, name.size() / 2);
  std::string small(name);
  std::ranges::transform(small, small.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const OptionDoc& doc : documents()) {
    const std::size_t d = edit_distance(small, doc.name);
    if (d < distance) best = doc.name, distance = d;
  }
  return best;
}

void refuse_unknown_options()
{
  const auto known = [](const std::string& name) {
    return is_documented(name) || (is_petsc_name(name) && !misspelt(name));
  };
  const auto& given = given_options();
  const auto first = std::ranges::find_if(given, [&](const auto& option) { return !known(option.first); });
  if (first == given.end()) return;
  const std::string unknown = first->first;
  const std::string nearest = nearest_option(unknown);
  throw UserError(nearest.empty()
                      ? fmt::format("{} is no option of pdxsolve: see pdxsolve -help", shown(unknown))
                      : fmt::format("{} is no option of pdxsolve: did you mean {}?", shown(unknown), nearest));
}
} // namespace pdx
