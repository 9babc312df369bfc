"""The tools for any coding agent: a Model Context Protocol server over stdio and loopback HTTP.

Nothing is imported here: the protocol's SDK is loaded by the modules that speak it, when `wsim mcp` starts one.
"""
