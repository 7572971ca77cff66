#pragma once
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace pdx::options {
/// A material of a list; none: the list does not say.
struct Material {
  std::string name;
  std::optional<double> young;     ///< [Pa]
  std::optional<double> poisson;   ///< [-]
  std::optional<double> density;   ///< [kg/m^3]
  std::optional<double> toughness; ///< energy release rate Gc [J/m^2]
};

/// The materials that a scene may name: those of -material_file, then those that came with the program
/// (src/options/materials.txt, whose comments say where the values are from).
class Materials {
public:
  /// Throws UserError for a file that cannot be read.
  static Materials read();
  /// That which an option names, or one that says nothing where the option is not given. Throws UserError for a name
  /// that is in no list.
  Material named(const std::string& option, const char* help) const;

private:
  std::vector<Material> all_;
};
} // namespace pdx::options
