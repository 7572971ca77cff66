#include "pdx/app/time_options.hpp"

#include "pdx/base/options.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>

namespace pdx::app {
namespace {
std::optional<double> number_in(std::string_view word)
{
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? std::optional(value) : std::nullopt;
}

/// A time and a factor a line, commas or blanks between; # begins a comment, and a first line of words is a header.
field::History read_table(const std::string& option, const std::string& name)
{
  std::ifstream file(name);
  if (!file) throw UserError(fmt::format("{} is {}: cannot be read", option, name));
  std::vector<field::History::Point> points;
  std::string text;
  bool headed = false;
  for (int number = 1; std::getline(file, text); ++number) {
    text.resize(std::min(text.size(), text.find('#')));
    std::ranges::replace(text, ',', ' ');
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    std::istringstream words(text);
    std::string first, second, more;
    words >> first >> second;
    const std::optional<double> time = number_in(first), factor = number_in(second);
    if (points.empty() && !headed && !time && !factor && std::isalpha(static_cast<unsigned char>(first[0]))) {
      headed = true;
      continue;
    }
    const std::string where = fmt::format("{} {}, line {}", option, name, number);
    if (!time || !factor || !std::isfinite(*time) || !std::isfinite(*factor) || words >> more)
      throw UserError(where + ": must be a time in s and a factor");
    if (!points.empty() && *time < points.back().time)
      throw UserError(fmt::format("{}: time {:g} is before {:g} of the line above", where, *time, points.back().time));
    points.push_back({*time, *factor});
  }
  if (points.empty()) throw UserError(fmt::format("{} is {}: has no line with a time and a factor", option, name));
  return field::History::table(std::move(points));
}
} // namespace

CheckpointOptions CheckpointOptions::read()
{
  Options o("checkpoint");
  CheckpointOptions c;
  c.interval = o.integer("-checkpoint_interval", 0, "steps from one checkpoint.h5 to the next; 0: none", {0.0, 1e9});
  c.seconds = o.real("-checkpoint_wall_seconds", 0.0, "s", "wall time from one checkpoint.h5 to the next; 0: none",
                     Range::at_least(0.0));
  c.restart = o.text("-restart", "", "checkpoint.h5 to go on from, on any number of ranks");
  return c;
}

TimeOptions TimeOptions::read()
{
  Options o("ts");
  static constexpr const char* kinds[] = {"static", "explicit", "implicit"};
  TimeOptions t;
  t.analysis = static_cast<Analysis>(
      o.choice("-analysis", 0, kinds, "equilibria under a growing load; explicit or implicit steps in time"));
  t.safety = o.real("-ts_safety", t.safety, "-", "explicit: share of the stable limit that a step takes without -ts_dt",
                    {0.0, 1.0, true});
  t.allow_unstable = o.boolean("-ts_allow_unstable", false, "explicit: let -ts_dt be above the stable limit");
  (void)o.real("-ts_dt", std::numeric_limits<double>::quiet_NaN(), "s",
               "length of a step; explicit: none for the limit's", Range::positive());
  (void)o.real("-ts_max_time", std::numeric_limits<double>::quiet_NaN(), "s", "end of the run", Range::positive());
  (void)o.integer("-ts_max_steps", std::numeric_limits<int>::max(), "most steps of the run", {1.0, 2147483647.0});
  t.checkpoint = CheckpointOptions::read();
  return t;
}

std::optional<field::History> read_history(Options& o, const std::string& stem)
{
  enum { constant, step, ramp, gaussian, table };
  static constexpr const char* shapes[] = {"constant", "step", "ramp", "gaussian", "table"};
  const std::string name = stem + "_history", at = name + "_time", over = name + "_width", from = name + "_file";
  const int shape =
      o.choice(name, 0, shapes, "factor in time: 1; 0 then 1; rising; exp(-((t - time)/width)^2); a file");
  const double time = o.real(at, 0.0, "s", "when it steps, begins to rise, or peaks");
  const double width = o.real(over, 0.0, "s", "how long it rises, or the pulse's width", Range::at_least(0.0));
  const std::string file = o.text(from, "", "table: CSV of time [s] and factor, straight in between");
  const auto refuse = [&](bool needed, const std::string& option) {
    if (o.given(option) && !needed)
      throw UserError(fmt::format("{} has no meaning for {} {}", option, name, shapes[shape]));
  };
  refuse(shape == step || shape == ramp || shape == gaussian, at);
  refuse(shape == ramp || shape == gaussian, over);
  refuse(shape == table, from);
  if ((shape == ramp || shape == gaussian) && width <= 0.0)
    throw UserError(fmt::format("{} {} needs a duration: give {} in s", name, shapes[shape], over));
  if (shape == table && file.empty()) throw UserError(fmt::format("{} table needs a file: give {}", name, from));
  if (!o.given(name)) return std::nullopt;
  switch (shape) {
  case step:
    return field::History::step(time);
  case ramp:
    return field::History::ramp(time, width);
  case gaussian:
    return field::History::gaussian(time, width);
  case table:
    return read_table(from, file);
  default:
    return field::History();
  }
}
} // namespace pdx::app
