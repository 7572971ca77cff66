#include "pdx/base/given_options.hpp"

#include "pdx/base/petsc_names.hpp"

#include <algorithm>
#include <cctype>

namespace pdx {
namespace {
using Store = std::map<std::string, GivenOption, std::less<>>;

Store& store()
{
  static Store all;
  return all;
}

bool in_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; }

/// The first given option of something, -bc_left_on of "-bc_left"; null: there is none.
const GivenOption* option_of(std::string_view stem)
{
  const auto found = store().lower_bound(std::string(stem) + "_");
  return stem.size() > 1 && found != store().end() && found->first.starts_with(std::string(stem) + "_") ? &found->second
                                                                                                        : nullptr;
}

/// The first given option that the beginning of a message, before its colon, names, or that belongs to what it names.
const GivenOption* named_in(std::string_view message)
{
  message = message.substr(0, message.find(": "));
  const GivenOption* near = nullptr;
  for (std::size_t at = message.find('-'); at != std::string_view::npos; at = message.find('-', at + 1)) {
    std::size_t end = at;
    while (end < message.size() && in_name(message[end])) ++end;
    const std::string_view name = message.substr(at, end - at);
    if (const GivenOption* option = given_option(name)) return option;
    if (!near && name.find('_') < name.size()) near = option_of(name);
    at = std::max(at, end - 1);
  }
  return near;
}

/// Does a message hold this word, nothing of a word before or behind it?
bool holds(std::string_view message, std::string_view word)
{
  const auto part = [&](std::size_t at) { return at < message.size() && (in_name(message[at]) || message[at] == '.'); };
  for (std::size_t at = message.find(word); at != std::string_view::npos; at = message.find(word, at + 1))
    if (!(at > 0 && part(at - 1)) && !part(at + word.size())) return true;
  return false;
}

/// PETSc tells only the value that it could not take, of type:file:format the file.
const GivenOption* of_petsc_in(std::string_view message)
{
  for (const auto& [name, option] : store()) {
    std::string_view value = option.value;
    if (const std::size_t colon = value.find(':'); colon != std::string_view::npos) {
      value.remove_prefix(colon + 1);
      value = value.substr(0, value.find(':'));
    }
    if (is_petsc_name(name) && !value.empty() && holds(message, value)) return &option;
  }
  return nullptr;
}
} // namespace

void give_option(GivenOption option) { store()[option.name] = std::move(option); }

void take_back_option(const std::string& name) { store().erase(name); }

const GivenOption* given_option(std::string_view name)
{
  const auto found = store().find(name);
  return found == store().end() ? nullptr : &found->second;
}

const Store& given_options() { return store(); }

std::string with_place(const std::string& message)
{
  const bool of_petsc = message.ends_with(kPetscValue);
  const GivenOption* option = of_petsc ? of_petsc_in(message) : named_in(message);
  if (!option) return message;
  const std::string text = of_petsc ? option->name + " " + option->value + ": " + message : message;
  return option->place.empty() ? text : option->place + ": " + text;
}
} // namespace pdx
