#pragma once
#include "pdx/scene/model.hpp"

namespace pdx::record {
/// Looks at what bodies that touch have come to, and tells once in a run where contact cannot hold them apart.
class ContactWatch {
public:
  /// Lines of warning: of bodies that lie deep in each other, and of those that meet too fast for their steps. The same
  /// on every rank. Collective.
  std::vector<std::string> look(MPI_Comm comm, const scene::Model& model);

private:
  bool deep_ = false, fast_ = false; ///< told
};
} // namespace pdx::record
