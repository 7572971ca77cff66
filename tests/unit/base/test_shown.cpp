#include "pdx/base/shown.hpp"

#include <gtest/gtest.h>

using namespace pdx;

TEST(Shown, LettersStayAndWhatCannotBeSeenIsEscaped)
{
  EXPECT_EQ(shown("plate \xC3\xBC"), "plate \xC3\xBC");
  EXPECT_EQ(shown(std::string_view("a\0b\r\x1b[0m", 8)), "a\\x00b\\x0d\\x1b[0m");
  EXPECT_EQ(shown("\xEF\xBB\xBFx"), "\\u{feff}x");
  EXPECT_EQ(shown("1e9\xC2\xA0"), "1e9\\u{00a0}");
  EXPECT_EQ(shown("\xE2\x80\x93mesh"), "\\u{2013}mesh");
  EXPECT_EQ(shown("\xFF\xC3"), "\\xff\\xc3");
}

TEST(Shown, CutsBetweenCharacters)
{
  EXPECT_EQ(shown("abcdef", 3), "abc...");
  EXPECT_EQ(shown("abc", 3), "abc");
  EXPECT_EQ(shown("\xC3\xBC\xC3\xBC\xC3\xBC", 2), "\xC3\xBC\xC3\xBC...");
}

TEST(Shown, OfALongPathTheEndIsKept)
{
  std::string given;
  while (given.size() < 5000) given += 'a'; // at once, g++ 12 sees an overflow that is none
  const std::string path = shown_path(given + "/case.opts");
  EXPECT_LT(path.size(), 130u);
  EXPECT_TRUE(path.starts_with("...a") && path.ends_with("/case.opts")) << path;
}

TEST(Shown, AMessageIsOneLineOfAtMost640Characters)
{
  EXPECT_EQ(as_one_line("two\nlines"), "two\\x0alines");
  const std::string line = as_one_line(std::string(500, 'a') + std::string(500, 'b') + "give another");
  EXPECT_LE(line.size(), 640u);
  EXPECT_TRUE(line.starts_with("aaa") && line.ends_with("give another")) << line;
}

TEST(Shown, ALongMessageIsCutBetweenWords)
{
  const std::string ours(620, 'x'); // the longest of ours stay whole
  EXPECT_EQ(as_one_line(ours), ours);
  std::string words;
  for (int k = 1000; words.size() < 1000; ++k) words += "word" + std::to_string(k) + " ";
  const std::string line = as_one_line(words);
  const std::size_t cut = line.find(" ... ");
  ASSERT_NE(cut, std::string::npos);
  EXPECT_EQ(line.substr(cut - 8, 4), "word") << line;
  EXPECT_EQ(line.substr(cut + 5, 4), "word") << line;
}
