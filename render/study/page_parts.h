// The files of page/, compiled in, so that a moved or installed tool can still write its page.
#pragma once

namespace lacuna {

extern const char* const kPageFrame;   ///< page.html, with {{parts}} to fill in
extern const char* const kPageStyle;   ///< page.css
extern const char* const kPageScript;  ///< all of page/*.js
}  // namespace lacuna
