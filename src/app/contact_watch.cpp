#include "pdx/app/contact_watch.hpp"

#include "pdx/couple/contact_books.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace pdx::app {
namespace {
constexpr double kTooDeep = 1.0 / 3.0; // of the distance at which points touch
constexpr double kTooFast = 0.25;      // likewise, a step
} // namespace

std::vector<std::string> ContactWatch::look(MPI_Comm comm, const Model& model)
{
  const couple::ContactBooks* books = model.touching ? model.touching->books() : nullptr;
  if (!books || (deep_ && fast_)) return {};
  const std::size_t pairs = books->pairs().size();
  std::vector<double> all(books->depths().begin(), books->depths().end());
  all.insert(all.end(), books->approaches().begin(), books->approaches().end());
  MPI_Allreduce(MPI_IN_PLACE, all.data(), static_cast<int>(all.size()), MPI_DOUBLE, MPI_MAX, comm);
  std::vector<std::string> lines;
  const auto worst = [&](std::size_t from) {
    return static_cast<std::size_t>(std::max_element(all.begin() + static_cast<std::ptrdiff_t>(from),
                                                     all.begin() + static_cast<std::ptrdiff_t>(from + pairs)) -
                                    all.begin());
  };
  const auto names = [&](std::size_t pair) {
    return fmt::format("{} and {}", books->pairs()[pair].first, books->pairs()[pair].second);
  };
  if (const std::size_t at = worst(0); !deep_ && all[at] > kTooDeep) {
    deep_ = true;
    lines.push_back(fmt::format("contact: points of {} lie {:.2f} of the distance at which they touch in each other's "
                                "skin, and pass through it at 1: take finer points, slower bodies or a higher "
                                "-contact_stiffness",
                                names(at), all[at]));
  }
  if (const std::size_t at = worst(pairs); !fast_ && all[at] > kTooFast) {
    fast_ = true;
    lines.push_back(fmt::format("contact: {} come nearer by {:.2f} of the distance at which they touch in a step, and "
                                "may pass through each other unseen: take shorter steps (-ts_safety, -ts_dt)",
                                names(at - pairs), all[at]));
  }
  return lines;
}
} // namespace pdx::app
