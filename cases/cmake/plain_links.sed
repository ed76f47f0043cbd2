# Replaces links to other documents by their text: pages of Doxygen do not include these documents.
s/\[([^]]*)\]\([^)]*\.md[^)]*\)/\1/g
