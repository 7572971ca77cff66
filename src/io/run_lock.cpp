#include "pdx/io/run_lock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <ctime>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

namespace pdx::io {
namespace {
using Json = nlohmann::ordered_json;
constexpr const char* kFile = "run.lock";
constexpr auto kBeat = std::chrono::seconds(5);     // from one touch of the file to the next
constexpr auto kSilence = std::chrono::seconds(40); // after which a run on another machine is over
constexpr int kTries = 20;                          // against others who take and leave it
constexpr std::size_t kLongestPath = 4096;

std::array<char, kLongestPath> held{}; // path of the lock of this run, for the end of the process

std::string host_name()
{
  char name[256] = "";
  (void)gethostname(name, sizeof name - 1);
  return name;
}

std::string first_line(const std::string& path)
{
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  return line;
}

/// When a process began, in ticks since the kernel did; 0 if there is none [proc(5), stat, field 22].
long long start_of(long process)
{
  const std::string stat = first_line(fmt::format("/proc/{}/stat", process));
  std::size_t at = stat.rfind(')');
  for (int field = 2; at != std::string::npos && field < 22; ++field) at = stat.find(' ', at + 1);
  return at == std::string::npos ? 0 : std::strtoll(stat.c_str() + at, nullptr, 10);
}

std::string kernel() { return first_line("/proc/sys/kernel/random/boot_id"); }

std::string local_time()
{
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  std::array<char, 32> text{};
  (void)std::strftime(text.data(), text.size(), "%F %T", localtime_r(&now, &parts));
  return text.data();
}

Json myself()
{
  return {{"host", host_name()},
          {"process", getpid()},
          {"since", local_time()},
          {"start", start_of(getpid())},
          {"kernel", kernel()}};
}

/// When the file was touched last; opened for that, as network file systems look anew then.
std::array<long, 2> touched(const std::filesystem::path& path)
{
  DiskFile file;
  struct stat status {};
  if (file.open(path, O_RDONLY) || fstat(file.descriptor(), &status) != 0) return {};
  return {status.st_mtim.tv_sec, status.st_mtim.tv_nsec};
}

bool has_name(int file, const std::filesystem::path& path)
{
  struct stat opened {
  }, named{};
  return fstat(file, &opened) == 0 && stat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
         opened.st_dev == named.st_dev;
}

std::string content(const DiskFile& file)
{
  std::string text(std::min<std::uint64_t>(file.size(), kLongestPath), '\0');
  return file.read(std::as_writable_bytes(std::span(text)), 0) ? "" : text;
}

Fault in_use(const std::filesystem::path& path, const std::string& owner)
{
  const Json json = Json::parse(owner, nullptr, false);
  const auto said = [&](const char* name) {
    const Json value = json.is_object() && json.contains(name) ? json[name] : Json("unknown");
    return value.is_string() ? value.get<std::string>() : value.dump();
  };
  return {fmt::format(
              "the directory '{}' is in use: process {} on {} has been running there since {}; wait for its end, or "
              "take another -output_dir",
              path.parent_path().string(), said("process"), said("host"), said("since")),
          false};
}
} // namespace

RunLock::RunLock(MPI_Comm comm, const std::filesystem::path& directory)
    : path_(std::filesystem::absolute(directory) / kFile)
{
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  settle(comm, rank == 0 ? take() : Fault{});
  const std::string path = path_.string();
  if (path.size() < held.size()) *std::copy(path.begin(), path.end(), held.begin()) = '\0';
  if (rank) return;
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before); // signals are for the thread that solves
  try {
    heart_ = std::thread([this] { beat(); });
  } catch (const std::system_error&) { // memory is short: on this machine the kernel's lock will do
  }
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

RunLock::~RunLock()
{
  if (heart_.joinable()) {
    {
      const std::lock_guard guard(mutex_);
      over_ = true;
    }
    end_.notify_all();
    heart_.join();
  }
  if (file_.is_open() && has_name(file_.descriptor(), path_)) (void)unlink(path_.c_str());
  held[0] = '\0';
}

void RunLock::drop() noexcept
{
  if (held[0]) (void)unlink(held.data());
}

void RunLock::beat()
{
  std::unique_lock lock(mutex_);
  while (!end_.wait_for(lock, kBeat, [this] { return over_; })) (void)futimens(file_.descriptor(), nullptr);
}

Fault RunLock::take()
{
  for (int k = 0; k < kTries; ++k) {
    if (const int code = file_.open(path_, O_RDWR | O_CREAT)) return path_fault("cannot create", path_, code);
    const bool locked = flock(file_.descriptor(), LOCK_EX | LOCK_NB) == 0;
    if (!locked && errno == EWOULDBLOCK) return in_use(path_, content(file_));
    if (!has_name(file_.descriptor(), path_)) continue; // whoever had it has just ended
    const std::string owner = content(file_);
    if (lives(owner, locked)) return in_use(path_, owner);
    if (!has_name(file_.descriptor(), path_)) continue;
    const std::string me = myself().dump() + "\n";
    int code = ftruncate(file_.descriptor(), 0) == 0 ? 0 : errno;
    if (!code) code = file_.write(std::as_bytes(std::span(me)), 0);
    if (code) (void)unlink(path_.c_str());
    return disk_fault("cannot write", path_, code);
  }
  return in_use(path_, "");
}

/// @param locked the kernel gave us its lock of the file, so that nobody under the same kernel can have it
bool RunLock::lives(const std::string& owner, bool locked)
{
  const Json json = Json::parse(owner, nullptr, false);
  if (!json.is_object() || !json.contains("host") || !json.contains("process") || !json.contains("start") ||
      !json.contains("kernel") || !json["process"].is_number_integer() || !json["start"].is_number_integer())
    return false; // killed before it had written it
  const bool same_kernel = json["kernel"] == kernel(), same_host = json["host"] == host_name();
  if (same_kernel && locked) return false;
  if (same_kernel && same_host) {
    const long process = json["process"];
    return (kill(static_cast<pid_t>(process), 0) == 0 || errno == EPERM) && start_of(process) == json["start"];
  }
  if (same_host) return false; // the machine was started anew
  const auto last = touched(path_);
  for (auto waited = std::chrono::seconds(0); waited < kSilence; ++waited) {
    if (touched(path_) != last) return true;
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  return false;
}
} // namespace pdx::io
