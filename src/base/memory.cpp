#include "pdx/base/memory.hpp"

#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <new>
#include <sys/resource.h>
#include <unistd.h>

namespace pdx {
namespace {
constexpr std::size_t kReserve = std::size_t{16} << 20; // [B]
void* reserve = nullptr;
void (*told)() noexcept = nullptr;

void release()
{
  std::set_new_handler(nullptr);
  if (reserve && told) told();
  std::free(reserve);
  reserve = nullptr;
}

/// A line "Key:   123 kB" of this process's status file [MB].
double status_mb(const char* key)
{
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(key)) return std::strtod(line.c_str() + std::strlen(key), nullptr) * 1024.0 / 1e6;
  return 0.0;
}
} // namespace

void keep_memory_reserve(void (*when_gone)() noexcept)
{
  if (reserve) return;
  told = when_gone;
  reserve = std::malloc(kReserve); // a block of its own, given back to the system when freed
  if (reserve) std::set_new_handler(release);
}

std::string memory_ran_out()
{
  release();
  char host[256] = "";
  (void)gethostname(host, sizeof host - 1);
  std::string limit = "the machine gives no more";
  rlimit most{};
  if (getrlimit(RLIMIT_AS, &most) == 0 && most.rlim_cur != RLIM_INFINITY)
    limit = fmt::format("the limit of its address space (ulimit -v) is {:.0f} MB",
                        static_cast<double>(most.rlim_cur) / 1e6);
  else if (getrlimit(RLIMIT_DATA, &most) == 0 && most.rlim_cur != RLIM_INFINITY)
    limit = fmt::format("the limit of its data (ulimit -d) is {:.0f} MB", static_cast<double>(most.rlim_cur) / 1e6);
  return fmt::format("memory ran out on {}, process {}: it has {:.0f} MB, {:.0f} MB of addresses, and {}; take more "
                     "machines, or fewer elements and particles",
                     host, getpid(), status_mb("VmRSS:"), status_mb("VmSize:"), limit);
}
} // namespace pdx
