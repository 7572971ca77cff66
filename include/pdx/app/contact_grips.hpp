#pragma once
#include "pdx/app/model.hpp"
#include "pdx/couple/contact_term.hpp"

namespace pdx::app {
/// Where friction holds points, of all ranks; none where nothing rubs, or no contact is. Collective.
template <int Dim> std::optional<NamedGrips> named_grips(MPI_Comm comm, const couple::ContactTerm<Dim>* contact);
/// The way back; points that are not here any more are let go.
template <int Dim> void hold_grips(couple::ContactTerm<Dim>* contact, const NamedGrips& named);
} // namespace pdx::app
