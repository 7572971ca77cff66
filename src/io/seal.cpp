#include "pdx/io/seal.hpp"

#include "pdx/base/fingerprint.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace pdx::io {
namespace {
constexpr std::string_view kMark = "pdxsolve sealed file, format ";

std::uint64_t size_of(std::string_view type) { return type == "u8" ? 1 : type == "i32" ? 4 : 8; }

std::uint64_t number_in(std::string_view& text, int base)
{
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, base);
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return error == std::errc() ? value : 0;
}

bool fills(const Seal& seal, std::uint64_t end)
{
  std::uint64_t at = Seal::kHeadBytes;
  for (const Seal::Extent& extent : seal.extents) {
    if (extent.at != at || extent.bytes == 0 || extent.bytes > Seal::kMostBytes || extent.bytes > end - at)
      return false;
    at += extent.bytes;
  }
  return at == end;
}

bool lies_in(const Seal::Table& table, std::uint64_t end)
{
  constexpr std::int64_t most = std::int64_t{1} << 40;
  if (table.rows < 0 || table.rows > most || table.columns < 1 || table.columns > 1 << 16) return false;
  return table.bytes() == 0 || (table.at >= Seal::kHeadBytes && table.at <= end && table.bytes() <= end - table.at);
}
} // namespace

std::uint64_t Seal::Table::bytes() const
{
  return static_cast<std::uint64_t>(rows) * static_cast<std::uint64_t>(columns) * size_of(type);
}

void Seal::cover(std::uint64_t at, std::span<const std::byte> bytes)
{
  for (; !bytes.empty(); at += kMostBytes) {
    const auto part = bytes.first(std::min<std::size_t>(bytes.size(), kMostBytes));
    extents.push_back({at, part.size(), hash_of(part)});
    bytes = bytes.subspan(part.size());
  }
}

std::string Seal::name_at(std::uint64_t at) const
{
  const auto found =
      std::ranges::find_if(tables, [&](const Table& table) { return at >= table.at && at - table.at < table.bytes(); });
  return found == tables.end() ? "" : found->name;
}

std::string Seal::text() const
{
  nlohmann::ordered_json json;
  for (const Table& t : tables)
    json["tables"].push_back(
        {{"name", t.name}, {"type", t.type}, {"rows", t.rows}, {"columns", t.columns}, {"at", t.at}});
  for (const Extent& e : extents) json["extents"].push_back({e.at, e.bytes, e.hash});
  return json.dump();
}

std::optional<Seal> Seal::from(std::string_view text, std::uint64_t end)
{
  try {
    const auto json = nlohmann::json::parse(text);
    Seal seal;
    for (const auto& t : json.at("tables"))
      seal.tables.push_back({t.at("name"), t.at("type"), t.at("rows"), t.at("columns"), t.at("at")});
    for (const auto& e : json.at("extents")) seal.extents.push_back({e.at(0), e.at(1), e.at(2)});
    const auto inside = [&](const Table& table) { return lies_in(table, end); };
    return fills(seal, end) && std::ranges::all_of(seal.tables, inside) ? std::optional(std::move(seal)) : std::nullopt;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

std::string SealHead::text() const
{
  std::string text = fmt::format("{}{}\ntable {} {} {:016x}\n", kMark, format, table_at, table_bytes, table_hash);
  text += fmt::format("{:016x}\n", hash_of(std::as_bytes(std::span(text))));
  text.resize(Seal::kHeadBytes, '\0');
  return text;
}

std::optional<SealHead> SealHead::from(std::string_view bytes)
{
  if (!bytes.starts_with(kMark)) return std::nullopt;
  std::string_view rest = bytes.substr(kMark.size());
  SealHead head;
  head.format = static_cast<int>(number_in(rest, 10));
  if (!rest.starts_with("\ntable ")) return head;
  rest.remove_prefix(7);
  const auto next = [&](int base) {
    const std::uint64_t value = number_in(rest, base);
    rest.remove_prefix(std::min<std::size_t>(rest.size(), 1));
    return value;
  };
  head.table_at = next(10);
  head.table_bytes = next(10);
  head.table_hash = next(16);
  return head;
}
} // namespace pdx::io
