/* near_file.h - a file that may be meant where there is none of the name.
 * SPDX-License-Identifier: Apache-2.0 */
#ifndef MEN_NEAR_FILE_H
#define MEN_NEAR_FILE_H

/* Of the files in a path's folder the one whose name is most like the path's: by suggest_nearest; or, of a.exr, the first frame of it,
 * a.0001.exr. With the path's own folder in front; the caller frees it. NULL: none is like it, or the folder cannot be read. Hidden files
 * and what is written at the moment (.tmp) are none. */
char *file_near(const char *path);

#endif
