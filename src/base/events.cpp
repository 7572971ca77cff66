#include "pdx/base/events.hpp"

namespace pdx {
namespace {
struct Record {
  EventCount total;
  double entered = 0.0;
};
std::map<std::string, Record>& records()
{
  static std::map<std::string, Record> all;
  return all;
}
int paused = 0;
PetscClassId our_class()
{
  static PetscClassId id = 0;
  if (!id) PDX_CALL(PetscClassIdRegister("pdxsolve", &id));
  return id;
}
} // namespace

void Event::begin()
{
  if (id_ < 0) PDX_CALL(PetscLogEventRegister(name_, our_class(), &id_));
  PDX_CALL(PetscLogEventBegin(id_, 0, 0, 0, 0));
  if (!paused) records()[name_].entered = MPI_Wtime();
}

void Event::end()
{
  (void)PetscLogEventEnd(id_, 0, 0, 0, 0);
  if (paused) return;
  Record& record = records()[name_];
  ++record.total.count;
  record.total.seconds += MPI_Wtime() - record.entered;
}

std::map<std::string, EventCount> event_counts()
{
  std::map<std::string, EventCount> counts;
  for (const auto& [name, record] : records()) counts[name] = record.total;
  return counts;
}

PauseCounts::PauseCounts() { ++paused; }
PauseCounts::~PauseCounts() { --paused; }
} // namespace pdx
