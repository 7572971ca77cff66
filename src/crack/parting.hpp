#pragma once
#include "pdx/crack/crack_set.hpp"

namespace pdx::crack {
/// At the corner prev -> v -> next: is x left of the crack, or on it? Exact.
bool left_at(const Vector<2>& prev, const Vector<2>& v, const Vector<2>& next, const Vector<2>& x);
/// Does the open chain of straight pieces part the bond from a to b? As CrackSet::cuts.
bool parts(const Polyline& chain, const Vector<2>& a, const Vector<2>& b);
/// Have the closed segments a-b and p-q a point in common? Exact.
bool meet(const Vector<2>& a, const Vector<2>& b, const Vector<2>& p, const Vector<2>& q);
} // namespace pdx::crack
