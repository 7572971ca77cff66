#include "pdx/options/time_options.hpp"

#include "pdx/base/given_options.hpp"
#include "pdx/base/number.hpp"
#include "pdx/base/options.hpp"
#include "pdx/base/petsc.hpp"
#include "pdx/base/shown.hpp"
#include "pdx/base/text_file.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>
#include <string_view>

namespace pdx::options {
namespace {
constexpr double kLeastThreshold = 1.01; // no partition is more even than that

/// What PETSc reads itself may have had a unit, which it does not know.
void hand_to_petsc(const char* name, double value)
{
  if (std::isfinite(value)) PDX_CALL(PetscOptionsSetValue(nullptr, name, fmt::format("{:.17g}", value).c_str()));
}

bool names_time(std::string_view word) { return word == "t" || word.starts_with("time") || word.starts_with("Time"); }

/// A time and a factor a line, commas or blanks between; # begins a comment, and a first line of words is a header.
field::History read_table(const std::string& option, const std::string& name)
{
  TextFile file(option, name);
  std::vector<field::History::Point> points;
  bool headed = false;
  while (file.next()) {
    const std::vector<std::string_view> words = words_of(file.line());
    if (words.empty()) continue;
    const std::vector<std::string_view> names = // of columns, units behind some
        file.line().find(',') != std::string_view::npos ? cells_of(file.line()) : words;
    const bool letters = std::ranges::all_of(names, [](std::string_view column) {
      return !column.empty() && std::isalpha(static_cast<unsigned char>(column[0])) && !real_in(column);
    });
    if (points.empty() && !headed && letters) {
      if (!names_time(names[0]) && std::ranges::any_of(names, names_time))
        file.refuse(fmt::format("names the columns \"{}\": the first must be the time", shown(file.line())));
      headed = true;
      continue;
    }
    if (words.size() != 2)
      file.refuse(
          fmt::format("has {} item{}: must be a time in s and a factor", words.size(), words.size() == 1 ? "" : "s"));
    const field::History::Point point{file.real(words[0]), file.real(words[1])};
    if (!points.empty() && point.time < points.back().time)
      file.refuse(fmt::format("time {:g} is before {:g} of the line above", point.time, points.back().time));
    points.push_back(point);
  }
  if (points.empty())
    throw UserError(fmt::format("{} is {}: has no line with a time and a factor", option, shown_path(name)));
  return field::History::table(std::move(points));
}

/// The same in the option itself: time:factor,time:factor,...
std::vector<field::History::Point> points_of(const std::string& option, const std::vector<std::string>& items)
{
  constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();
  std::vector<field::History::Point> points;
  for (const std::string& item : items) {
    const std::size_t colon = item.find(':');
    const bool both = colon != std::string::npos;
    const double time = both ? number_of(option, item.substr(0, colon), "s").value_or(kNoNumber) : kNoNumber;
    const double factor = both ? number_of(option, item.substr(colon + 1), "-").value_or(kNoNumber) : kNoNumber;
    if (!std::isfinite(time) || !std::isfinite(factor))
      throw UserError(fmt::format("{} is \"{}\" in item {}: must be a time in s and a factor, e.g. 1e-3:0.5", option,
                                  shown(item), points.size() + 1));
    if (!points.empty() && time < points.back().time)
      throw UserError(
          fmt::format("{}: time {:g} is before {:g} of the item in front of it", option, time, points.back().time));
    points.push_back({time, factor});
  }
  return points;
}
} // namespace

CheckpointOptions CheckpointOptions::read()
{
  Options o("checkpoint");
  CheckpointOptions c;
  c.interval = o.integer("-checkpoint_interval", 0,
                         "steps, or loads accepted, from one checkpoint.h5 to the next; 0: none", {0.0, 1e9});
  c.seconds = o.real("-checkpoint_wall_seconds", 0.0, "s", "wall time from one checkpoint.h5 to the next; 0: none",
                     Range::at_least(0.0));
  c.restart = o.text("-restart", "", "checkpoint.h5 to go on from, on any number of ranks");
  return c;
}

namespace {
Triggers read_triggers(Options& o)
{
  static constexpr const char* kinds[] = {"damage", "connection", "stress", "stretch"};
  Triggers t;
  t.damage = false;
  const std::vector<std::string> names =
      o.texts("-adapt_trigger", {"damage"},
              "what makes elements and material points particles, with -adapt expand: damage = bonds that broke near; "
              "connection = bonds that a crack cuts or that would break; stress, stretch = what they bear");
  for (const std::string& name : names) {
    const auto kind = std::ranges::find(kinds, name) - std::begin(kinds);
    if (kind == std::ssize(kinds))
      throw UserError(
          fmt::format("-adapt_trigger has \"{}\": must be of damage, connection, stress, stretch", shown(name)));
    (kind == 0 ? t.damage : kind == 1 ? t.connection : kind == 2 ? t.stress : t.stretch) = true;
  }
  t.largest_stress = o.real("-adapt_stress", 0.0, "Pa",
                            "largest principal stress that bulk bears, for the trigger stress", Range::at_least(0.0));
  t.stretch_share = o.real("-adapt_stretch", 0.8, "-",
                           "share of the critical stretch that bulk bears, for the trigger stretch", Range::positive());
  t.margin = o.integer("-adapt_margin", 2, "cells around what asks that become particles with it", {0.0, 1e6});
  if (t.stress && t.largest_stress == 0.0)
    throw UserError("-adapt_stress is missing: give the principal stress in Pa at which bulk becomes particles");
  if (!t.stress && o.given("-adapt_stress"))
    throw UserError("-adapt_stress is of -adapt_trigger stress: give that too, or drop it");
  if (!t.stretch && o.given("-adapt_stretch"))
    throw UserError("-adapt_stretch is of -adapt_trigger stretch: give that too, or drop it");
  if (!t.any() && o.given("-adapt_margin"))
    throw UserError("-adapt_margin is of -adapt_trigger connection, stress and stretch: give one, or drop it");
  return t;
}
} // namespace

bool Triggers::are_given()
{
  const GivenOption* trigger = given_option("-adapt_trigger");
  return trigger && trigger->value != "damage" && given_option("-adapt");
}

LayoutOptions LayoutOptions::read()
{
  Options o("layout");
  LayoutOptions l;
  l.renew_interval = o.integer("-layout_renew_interval", 0,
                               "diagnostic: steps or loads after which rows, Terms and solvers are made anew and take "
                               "their state over by name; 0: never",
                               {0.0, 1e9});
  const std::vector<double> box =
      o.reals("-layout_renew_box", {}, 4, "m",
              "diagnostic: box whose cells become particles at one such change, and elements at the next");
  if (!box.empty()) l.renew_box = geom::Box<2>{{box[0], box[1]}, {box[2], box[3]}};
  if (l.renew_box && (l.renew_box->size().array() <= 0.0).any())
    throw UserError("-layout_renew_box has no inside: give x0,y0,x1,y1");
  if (l.renew_box && l.renew_interval == 0)
    throw UserError("-layout_renew_box changes hands with -layout_renew_interval: give that too");
  l.rebalance_threshold =
      o.real("-rebalance_threshold", 0.0, "-",
             "explicit: time of the busiest rank over the mean above which cells are dealt out anew "
             "by what they take; 0: never",
             Range::at_least(0.0));
  static constexpr const char* kinds[] = {"none", "expand", "relocate"};
  l.adapt = static_cast<Adapt>(o.choice("-adapt", 0, kinds,
                                        "what patches do while cracks grow: nothing, elements ahead become particles, "
                                        "or particles behind become elements too"));
  l.critical_length =
      o.real("-adapt_critical_length", 0.0, "m",
             "patches move where bonds broke as near to elements; 0: explicit the larger of 3 horizons and an element, "
             "static 2 horizons",
             Range::at_least(0.0));
  l.expansion_length = o.real("-adapt_expansion_length", 0.0, "m",
                              "elements with a node as near to such bonds, or to a tip of -adapt_seed, become "
                              "particles; 0: explicit the larger of 7 horizons and 2 "
                              "elements, static 4 horizons",
                              Range::at_least(0.0));
  l.contraction_length =
      o.real("-adapt_contraction_length", 0.0, "m",
             "particles as far behind a tip become elements; 0: explicit the larger of 8 horizons and 2.4 elements, "
             "static 4 horizons",
             Range::at_least(0.0));
  l.expansions = o.integer("-adapt_expansions", 1, "expansions from one such contraction to the next", {1.0, 1e9});
  static constexpr const char* trackers[] = {"sides", "laplacian"};
  l.tracker = static_cast<track::Tracker>(
      o.choice("-adapt_tracker", 0, trackers,
               "how cracks are followed that elements take over: between the bodies that bonds hold together, or where "
               "the Laplacian of damage is lowest"));
  l.triggers = read_triggers(o);
  l.adapt_interval =
      o.integer("-adapt_every", 1, "explicit: steps from one look for such bonds, or at what bulk bears, to the next",
                {1.0, 1e9});
  static constexpr const char* at_border[] = {"warn", "stop"};
  l.hand_back = o.integer("-adapt_hand_back", 0,
                          "steps after which particles that -adapt_trigger made, whole and bearing less than half of "
                          "what it says, become points or elements again; 0: never",
                          {0.0, 1e9});
  if (l.hand_back > 0 && !l.triggers.any())
    throw UserError("-adapt_hand_back undoes what -adapt_trigger connection, stress and stretch do: give one of them, "
                    "or drop it");
  l.stops_at_border = o.choice("-adapt_border", 0, at_border,
                               "where a crack comes within a horizon of elements and -adapt is none: a warning, or the "
                               "end of the run with status 2") == 1;
  if (l.rebalance_threshold > 0.0 && l.rebalance_threshold < kLeastThreshold)
    throw UserError(fmt::format("-rebalance_threshold is {}: must be 0 (never) or at least {}", l.rebalance_threshold,
                                kLeastThreshold));
  return l;
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
  t.subcycle =
      o.integer("-ts_subcycle", 1,
                "explicit: steps that particles, and elements beside them, take in one step, of -ts_dt, of all "
                "other elements",
                {1.0, 1000.0});
  hand_to_petsc("-ts_dt", o.real("-ts_dt", std::numeric_limits<double>::quiet_NaN(), "s",
                                 "length of a step; explicit: none for the limit's", Range::positive()));
  hand_to_petsc("-ts_max_time", o.real("-ts_max_time", std::numeric_limits<double>::quiet_NaN(), "s", "end of the run",
                                       Range::positive()));
  (void)o.integer("-ts_max_steps", std::numeric_limits<int>::max(), "most steps of the run", {1.0, 2147483647.0});
  t.checkpoint = CheckpointOptions::read();
  return t;
}

namespace {
field::History history_of(const std::string& option, const std::string& text)
{
  constexpr double parts = 256.0; // of the run
  const auto seconds = [](const char* name) {
    const GivenOption* given = given_option(name);
    return given ? number_of(name, given->value, "s").value_or(0.0) : 0.0;
  };
  const double last = seconds("-ts_max_time"), dt = seconds("-ts_dt");
  const double span = last > 0.0 ? last / parts : dt > 0.0 ? 16.0 * dt : 1e-3;
  const auto refuse = [&](const std::string& why) {
    throw UserError(fmt::format("{} is \"{}\": {}", option, shown(text), why));
  };
  if (text.empty()) refuse("must be a formula of the time t in s");
  field::History history;
  try {
    history = field::History::expression(text, span);
  } catch (const UserError& wrong) {
    refuse(wrong.what());
  }
  for (const double time : {0.0, last})
    if (!std::isfinite(history.value(time))) refuse(fmt::format("it is no number at t = {:g} s", time));
  return history;
}
} // namespace

std::optional<field::History> read_history(Options& o, const std::string& stem)
{
  enum { constant, step, ramp, gaussian, table, expression };
  static constexpr const char* shapes[] = {"constant", "step", "ramp", "gaussian", "table", "expression"};
  const std::string name = stem + "_history", at = name + "_time", over = name + "_width", from = name + "_file",
                    within = name + "_points", formula = name + "_expression";
  const int shape = o.choice(
      name,
      o.given(within)    ? table
      : o.given(formula) ? expression
                         : constant,
      shapes, "factor in time: 1; 0 then 1; rising; exp(-((t - time)/width)^2); straight between points; a formula");
  const double time = o.real(at, 0.0, "s", "when it steps, begins to rise, or peaks");
  const double width = o.real(over, 0.0, "s", "how long it rises, or the pulse's width", Range::at_least(0.0));
  const std::string file = o.text(from, "", "table: CSV of time [s] and factor, straight in between");
  const std::vector<std::string> items =
      o.texts(within, {}, "table: the points here, time:factor,time:factor,..., e.g. 0:0,1ms:1,2ms:0");
  const std::string text =
      o.text(formula, "", "expression: the factor as a formula of t in s, e.g. \"sin(2*pi*t/1e-3)*min(t/1e-6, 1)\"");
  const auto refuse = [&](bool needed, const std::string& option) {
    if (o.given(option) && !needed)
      throw UserError(fmt::format("{} has no meaning for {} {}", option, name, shapes[shape]));
  };
  refuse(shape == step || shape == ramp || shape == gaussian, at);
  refuse(shape == ramp || shape == gaussian, over);
  refuse(shape == table, from);
  refuse(shape == table, within);
  refuse(shape == expression, formula);
  if ((shape == ramp || shape == gaussian) && width <= 0.0)
    throw UserError(fmt::format("{} {} needs a duration: give {} in s", name, shapes[shape], over));
  if (shape == table && file.empty() && items.empty())
    throw UserError(fmt::format("{} table needs points: give {} or {}", name, from, within));
  if (!file.empty() && !items.empty())
    throw UserError(fmt::format("{} and {} say the same: give one of them", from, within));
  if (!o.given(name) && items.empty() && !o.given(formula)) return std::nullopt;
  switch (shape) {
  case step:
    return field::History::step(time);
  case ramp:
    return field::History::ramp(time, width);
  case gaussian:
    return field::History::gaussian(time, width);
  case table:
    return items.empty() ? read_table(from, file) : field::History::table(points_of(within, items));
  case expression:
    return history_of(formula, text);
  default:
    return field::History();
  }
}
} // namespace pdx::options
