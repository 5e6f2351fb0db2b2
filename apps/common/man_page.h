// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace pcl_slim {

/** \brief Text for man of a few words: dashes of options, backslashes and accents are escaped. */
std::string manText(const std::string& text);

/** \brief A manual page of section 1, in the macros of man(7). */
class ManPage {
 public:
  /** \param[in] summary one sentence, which becomes the line of whatis. */
  ManPage(const std::string& program, const std::string& version, const std::string& summary);

  void section(const std::string& title);
  /** \brief A way to call the program. \param[in] rest its arguments */
  void form(const std::string& program, const std::string& rest);
  void paragraph(const std::string& text);
  /** \brief A term in bold letters, what follows it on its line, and its meaning below. */
  void item(const std::string& term, const std::string& rest, const std::string& meaning);
  /** \brief Exit status of every program. \param[in] more those of this one alone */
  void exitStatus(const std::vector<std::pair<int, std::string>>& more = {});
  /** \brief The last section: other pages, which are sorted here. */
  void seeAlso(std::vector<std::string> programs);

  const std::string& text() const { return text_; }

 private:
  /** Adds text in lines of less than 80 bytes. */
  void wrap(const std::string& text);

  std::string text_;
};

}  // namespace pcl_slim
