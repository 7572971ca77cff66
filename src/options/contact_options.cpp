#include "pdx/base/error.hpp"
#include "pdx/base/options.hpp"
#include "pdx/options/point_options.hpp"

#include <fmt/format.h>

namespace pdx::options {
ContactOptions ContactOptions::read(bool any_points, bool describe)
{
  Options o("contact");
  static constexpr const char* laws[] = {"none", "penalty"};
  ContactOptions contact;
  contact.active = o.choice("-contact", 1, laws, "bodies of material points that meet: pass through, or push") == 1;
  contact.stiffness =
      o.real("-contact_stiffness", 0.0, "Pa",
             "modulus of the layer between bodies that touch; 0: that of their materials", Range::at_least(0.0));
  contact.friction = o.real("-contact_friction", 0.0, "-", "Coulomb's coefficient of friction", Range::at_least(0.0));
  static constexpr const char* skins[] = {"border", "sites"};
  contact.by_sites =
      o.choice("-contact_skin", 0, skins,
               "what bodies of points touch by: the border of their shapes, or the sites of their points") == 1;
  if (describe) return contact;
  for (const char* name : {"-contact", "-contact_stiffness", "-contact_friction", "-contact_skin"}) {
    if (!o.given(name)) continue;
    if (!any_points)
      throw UserError(fmt::format("{} is of material points, and there are none: give -mpm_bodies", name));
    if (!contact.active && std::string_view(name) != "-contact")
      throw UserError(fmt::format("{} says how bodies touch, and -contact none that they do not: drop one", name));
  }
  return contact;
}
} // namespace pdx::options
