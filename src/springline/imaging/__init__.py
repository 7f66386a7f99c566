"""Images: edges, rings, unwrapping and the decision on laterals and joints; OpenCV is used nowhere else.

Stands on `geometry`, `conventions` and `errors`. Pixel positions are (column, row) with pixel centres at whole numbers
and rows downwards; what touches the lens uses z right and y up from its principal point, as `geometry.camera` does.
"""
